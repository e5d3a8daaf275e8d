//! Steps back and forth through what was staged in a module. What was written is no step any more: the module holds it.

use std::collections::BTreeMap;

use super::edits::Edit;
use super::module::Module;
use crate::module::Kind;

/// Steps kept for each module.
const MOST: usize = 100;

/// The text of an item's edit; `None` where there is none.
type Text = Option<String>;

/// One thing that the user did.
#[derive(Debug, Clone, PartialEq)]
struct Step {
    /// What was done, as in "Undo: Response delay".
    name: String,
    /// An item that is typed, so that what is typed into it next belongs to the same step.
    typed: Option<String>,
    /// By item id, before and after.
    texts: BTreeMap<String, (Text, Text)>,
}

/// What was done, and what was undone since.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Undo {
    done: Vec<Step>,
    undone: Vec<Step>,
}

impl Undo {
    fn note(&mut self, step: Step) {
        self.undone.clear();
        let again = self.done.last_mut().filter(|last| last.typed.is_some() && last.typed == step.typed);
        match again {
            Some(last) => {
                for (id, (_, after)) in step.texts {
                    if let Some((_, known)) = last.texts.get_mut(&id) {
                        *known = after;
                    }
                }
                if last.texts.values().all(|(before, after)| before == after) {
                    self.done.pop();
                }
            }
            None => self.done.push(step),
        }
        if self.done.len() > MOST {
            self.done.remove(0);
        }
    }

    /// The module holds what was staged for this item.
    fn forget(&mut self, id: &str) {
        for steps in [&mut self.done, &mut self.undone] {
            for step in steps.iter_mut() {
                step.texts.remove(id);
            }
            steps.retain(|step| !step.texts.is_empty());
        }
    }
}

impl Module {
    /// What [`Action::Undo`](super::Action::Undo) takes back; `None` if there is nothing, or if it is on its way to the module.
    pub fn undoable(&self) -> Option<&str> {
        self.undo.done.last().filter(|step| self.is_free(step)).map(|step| step.name.as_str())
    }

    /// What [`Action::Redo`](super::Action::Redo) does again, as [`Self::undoable`].
    pub fn redoable(&self) -> Option<&str> {
        self.undo.undone.last().filter(|step| self.is_free(step)).map(|step| step.name.as_str())
    }

    fn is_free(&self, step: &Step) -> bool {
        !step.texts.keys().any(|id| self.edit(id).is_some_and(Edit::is_being_written))
    }

    /// One step back.
    pub(super) fn undo(&mut self) {
        if self.undoable().is_none() {
            return;
        }
        let Some(step) = self.undo.done.pop() else { return };
        step.texts.iter().for_each(|(id, (before, _))| self.put(id, before.as_deref()));
        self.undo.undone.push(step);
    }

    /// One step forth.
    pub(super) fn redo(&mut self) {
        if self.redoable().is_none() {
            return;
        }
        let Some(step) = self.undo.undone.pop() else { return };
        step.texts.iter().for_each(|(id, (_, after))| self.put(id, after.as_deref()));
        // What is typed next is a step of its own.
        self.undo.done.push(Step { typed: None, ..step });
    }

    /// Changes an item for writing it later, as a step that can be undone.
    pub(super) fn stage(&mut self, id: &str, text: &str) {
        let Some(item) = self.item(id) else { return };
        let name = item.label.clone();
        let typed = matches!(item.kind, Kind::Number { .. } | Kind::Text { .. } | Kind::Ipv4).then(|| id.to_owned());
        self.as_step(name, typed, |module| module.put(id, Some(text)));
    }

    /// Takes back what is not on its way to the module already, as a step that can be undone.
    pub(super) fn revert(&mut self, id: Option<&str>) {
        let name = match id {
            Some(id) => format!("revert {}", self.item(id).map_or(id, |item| item.label.as_str())),
            None => "revert all changes".to_owned(),
        };
        self.as_step(name, None, |module| {
            module.edits.retain(|edited, edit| edit.is_being_written() || id.is_some_and(|id| id != edited));
        });
    }

    /// The module holds what was staged for this item, so that there is nothing to undo.
    pub(super) fn forget_steps_of(&mut self, id: &str) {
        self.undo.forget(id);
    }

    /// Lets `change` change the edits, and notes what it changed.
    fn as_step(&mut self, name: String, typed: Option<String>, change: impl FnOnce(&mut Self)) {
        let texts = |module: &Self| -> BTreeMap<String, String> {
            module.edits.iter().map(|(id, edit)| (id.clone(), edit.text.clone())).collect()
        };
        let before = texts(self);
        change(self);
        let after = texts(self);
        let changed = before.keys().chain(after.keys()).filter(|id| before.get(*id) != after.get(*id));
        let texts: BTreeMap<_, _> =
            changed.map(|id| (id.clone(), (before.get(id).cloned(), after.get(id).cloned()))).collect();
        if !texts.is_empty() {
            self.undo.note(Step { name, typed, texts });
        }
    }

    /// Stages `text`, or nothing; a change to what the module holds is none.
    fn put(&mut self, id: &str, text: Option<&str>) {
        if self.edit(id).is_some_and(Edit::is_being_written) {
            return;
        }
        let edit = text.zip(self.item(id)).map(|(text, item)| Edit::new(item, text));
        let is_change = |edit: &Edit| !matches!(&edit.value, Ok(value) if self.known(id) == Some(value));
        match edit.filter(is_change) {
            Some(edit) => drop(self.edits.insert(id.to_owned(), edit)),
            None => drop(self.edits.remove(id)),
        }
    }
}

#[cfg(test)]
mod tests;
