//! Which row of a file is which module and series of the history that is recorded.

use std::collections::{BTreeMap, HashMap, HashSet};

use rusqlite::{Connection, Result};

use super::super::history::Record;
use super::super::objects::{ModuleId, ModuleInfo, SeriesId, SeriesInfo};
use super::rows;

/// What there is to record, as it was told last.
#[derive(Debug, Default)]
pub struct Catalogue {
    modules: BTreeMap<ModuleId, ModuleInfo>,
    series: BTreeMap<SeriesId, SeriesInfo>,
    /// Grows with every change.
    version: u64,
}

impl Catalogue {
    /// Takes in a module or series.
    pub fn take(&mut self, record: Record) {
        match record {
            Record::Module(id, info) => drop(self.modules.insert(id, info)),
            Record::Series(id, info) => drop(self.series.insert(id, info)),
            Record::Sample(..) | Record::Event(_) => return,
        }
        self.version = self.version.saturating_add(1);
    }
}

/// The rows of one file.
#[derive(Debug, Default)]
pub struct Rows {
    modules: HashMap<ModuleId, (i64, ModuleInfo)>,
    series: HashMap<SeriesId, i64>,
    taken: HashSet<i64>,
    version: Option<u64>,
}

impl Rows {
    pub fn module(&self, id: ModuleId) -> Option<i64> {
        self.modules.get(&id).map(|(row, _)| *row)
    }

    pub fn series(&self, id: SeriesId) -> Option<i64> {
        self.series.get(&id).copied()
    }

    pub fn all_series(&self) -> &HashMap<SeriesId, i64> {
        &self.series
    }

    /// Brings the file up to date. True if anything was new.
    pub fn update(&mut self, connection: &Connection, catalogue: &Catalogue) -> Result<bool> {
        if self.version == Some(catalogue.version) {
            return Ok(false);
        }
        for (id, info) in &catalogue.modules {
            self.update_module(connection, *id, info)?;
        }
        for (id, info) in &catalogue.series {
            if !self.series.contains_key(id) {
                self.add_series(connection, *id, info)?;
            }
        }
        self.version = Some(catalogue.version);
        Ok(true)
    }

    fn update_module(&mut self, connection: &Connection, id: ModuleId, info: &ModuleInfo) -> Result<()> {
        let row = match self.modules.get(&id) {
            Some((_, known)) if known == info => return Ok(()),
            Some((row, _)) => Some(*row),
            None => self.find_module(connection, info)?,
        };
        let row = rows::put_module(connection, row, info)?;
        self.taken.insert(row);
        self.modules.insert(id, (row, info.clone()));
        Ok(())
    }

    /// The row of an earlier run that means this module: the same model at the same place, and not another one by name.
    fn find_module(&self, connection: &Connection, info: &ModuleInfo) -> Result<Option<i64>> {
        let (mut same, mut similar) = (None, None);
        rows::rows(connection, rows::MODULES, [], rows::module, |(row, known)| {
            if self.taken.contains(&row) {
                return;
            }
            if known == *info {
                same = same.or(Some(row));
            } else if is_similar(&known, info) {
                similar = similar.or(Some(row));
            }
        })?;
        Ok(same.or(similar))
    }

    fn add_series(&mut self, connection: &Connection, id: SeriesId, info: &SeriesInfo) -> Result<()> {
        let Some((module, described)) = self.modules.get(&info.module) else { return Ok(()) };
        let (mut row, mut other) = (None, false);
        rows::rows(connection, rows::SERIES, [], rows::series, |(found, of, known)| {
            if of == *module && known.item == info.item {
                let same = known.unit == info.unit && known.kind == info.kind;
                (row, other) = if same { (Some(found), other) } else { (row, true) };
            }
        })?;
        let row = match row {
            Some(row) => row,
            // The item had another meaning in an earlier run, whose samples keep it: the module stands there twice.
            None if other => rows::add_series(connection, rows::put_module(connection, None, described)?, info)?,
            None => rows::add_series(connection, *module, info)?,
        };
        self.series.insert(id, row);
        Ok(())
    }
}

fn is_similar(one: &ModuleInfo, other: &ModuleInfo) -> bool {
    let place = |info: &ModuleInfo| (info.line.clone(), info.address, info.protocol.clone(), info.model.clone());
    let agree = |one: &str, other: &str| one.is_empty() || other.is_empty() || one == other;
    place(one) == place(other) && agree(&one.name, &other.name)
}
