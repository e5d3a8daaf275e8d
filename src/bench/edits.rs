//! What a user has changed but the module does not hold yet, and what is to be said of each value.

use jiff::Timestamp;

use super::module::{Module, Reading};
use crate::bus::RequestId;
use crate::module::{Applies, Item, Value};
use crate::protocol::Failure;

/// A value that waits to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct Edit {
    /// As the user wrote it.
    pub text: String,
    /// What that means, or which values are allowed.
    pub value: Result<Value, String>,
    pub state: EditState,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum EditState {
    Staged,
    Writing(RequestId),
    /// The last attempt failed for this reason; the module holds what its reading says.
    Refused(String),
}

/// What is to be said of an item's value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ItemState<'a> {
    /// Never asked for.
    Unknown,
    BeingRead,
    /// The module said so at this time.
    Current(Timestamp),
    /// Changed by the user, not written.
    Edited,
    /// Changed to something that the item does not take: the allowed values.
    Invalid(&'a str),
    BeingWritten,
    /// Not taken, and why.
    Refused(&'a str),
    /// The last attempt to read it brought nothing.
    Unreadable(&'a Failure),
}

impl Edit {
    /// What `text` means for `item`.
    pub fn new(item: &Item, text: &str) -> Self {
        Self {
            text: text.to_owned(),
            value: item.parse(text).map_err(|_| format!("use {}", item.allowed())),
            state: EditState::Staged,
        }
    }

    pub fn is_being_written(&self) -> bool {
        matches!(self.state, EditState::Writing(_))
    }
}

impl Module {
    pub fn edit(&self, id: &str) -> Option<&Edit> {
        self.edits.get(id)
    }

    /// What the module said last.
    pub fn known(&self, id: &str) -> Option<&Value> {
        self.reading(id).and_then(|reading| reading.value.as_ref())
    }

    /// What the user wants, else what the module said last.
    pub fn wanted(&self, id: &str) -> Option<&Value> {
        match self.edit(id) {
            Some(Edit { value: Ok(value), .. }) => Some(value),
            _ => self.known(id),
        }
    }

    pub fn state(&self, id: &str) -> ItemState<'_> {
        if let Some(edit) = self.edit(id) {
            return match (&edit.state, &edit.value) {
                (EditState::Writing(_), _) => ItemState::BeingWritten,
                (EditState::Refused(reason), _) => ItemState::Refused(reason),
                (EditState::Staged, Err(allowed)) => ItemState::Invalid(allowed),
                (EditState::Staged, Ok(_)) => ItemState::Edited,
            };
        }
        if self.is_being_read(id) {
            return ItemState::BeingRead;
        }
        match self.reading(id) {
            Some(Reading { problem: Some(failure), .. }) => ItemState::Unreadable(failure),
            Some(Reading { at: Some(at), value: Some(_), .. }) => ItemState::Current(*at),
            _ => ItemState::Unknown,
        }
    }

    /// Ids of the items that the user changed, in the order in which they are to be written: what moves the module to
    /// another address comes last, because everything else is sent to the present one.
    pub fn edited(&self) -> Vec<&str> {
        let moves = |id: &str| matches!(id, "address" | "net_id");
        let mut ids: Vec<&str> = self.edits.keys().map(String::as_str).collect();
        ids.sort_by_key(|id| moves(id));
        ids
    }

    /// Edits that need INIT mode (DIP 4 ON).
    pub fn edited_for_init(&self) -> Vec<&str> {
        let needs = |id: &&str| self.item(id).is_some_and(|item| item.applies == Applies::Init);
        self.edited().into_iter().filter(needs).collect()
    }

    /// Why the edits cannot be written as they are, if so.
    pub fn unwritable(&self) -> Option<String> {
        self.edits.iter().find_map(|(id, edit)| {
            let label = self.item(id).map_or(id.as_str(), |item| item.label.as_str());
            edit.value.as_ref().err().map(|allowed| format!("{label} cannot be \"{}\": {allowed}", edit.text))
        })
    }
}
