//! Parquet: times in microseconds UTC, numbers as doubles, switches as booleans, words as UTF-8 text.
//!
//! A column whose cells may be anything becomes two: numbers, with switches as 0 and 1, under its own name, and `word`.

use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, TimeUnit, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};

use super::ExportError;
use super::table::{Cell, Column, ColumnKind, Sink};

/// Rows written at once.
const ROW_GROUP: usize = 65_536;
/// Cells held in memory at once, whatever the number of columns.
const MOST_CELLS: usize = 4_000_000;

pub(super) struct ParquetSink<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    /// Each with the column of the table that it takes.
    buffers: Vec<(usize, Buffer)>,
    rows: usize,
    most_rows: usize,
}

impl<W: Write + Send> ParquetSink<W> {
    pub fn new(columns: &[Column], writer: W) -> Result<Self, ExportError> {
        let (mut buffers, mut fields) = (Vec::new(), Vec::new());
        for (place, column) in columns.iter().enumerate() {
            for (name, values) in physical(column) {
                fields.push(values.field(name).map_err(failed)?);
                buffers.push((place, Buffer { values, levels: Vec::new() }));
            }
        }
        let schema = Type::group_type_builder("schema").with_fields(fields).build().map_err(failed)?;
        let writer = SerializedFileWriter::new(writer, Arc::new(schema), Arc::new(properties())).map_err(failed)?;
        let most_rows = (MOST_CELLS / buffers.len().max(1)).clamp(1, ROW_GROUP);
        Ok(Self { writer, buffers, rows: 0, most_rows })
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        if self.rows == 0 {
            return Ok(());
        }
        let mut group = self.writer.next_row_group()?;
        for (_, buffer) in &mut self.buffers {
            if let Some(column) = group.next_column()? {
                buffer.write(column)?;
            }
        }
        group.close()?;
        self.rows = 0;
        Ok(())
    }
}

impl<W: Write + Send> Sink for ParquetSink<W> {
    fn put(&mut self, row: &[Cell]) -> Result<(), ExportError> {
        for (place, buffer) in &mut self.buffers {
            buffer.push(row.get(*place).unwrap_or(&Cell::Empty));
        }
        self.rows = self.rows.saturating_add(1);
        if self.rows >= self.most_rows { self.write_group().map_err(failed) } else { Ok(()) }
    }

    fn end(mut self) -> Result<(), ExportError> {
        self.write_group().map_err(failed)?;
        let mut writer = self.writer.into_inner().map_err(failed)?;
        Ok(writer.flush()?)
    }
}

fn properties() -> WriterProperties {
    let entry = |key: &str, value: &str| KeyValue::new(key.to_owned(), value.to_owned());
    let (name, version) = (env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"));
    WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by(format!("{name} version {version}"))
        .set_key_value_metadata(Some(vec![entry("program", name), entry("version", version)]))
        .build()
}

fn physical(column: &Column) -> Vec<(&str, Values)> {
    let name = column.name.as_str();
    match column.kind {
        ColumnKind::Time => vec![(name, Values::Times(Vec::new()))],
        ColumnKind::Number => vec![(name, Values::Numbers(Vec::new()))],
        ColumnKind::Switch => vec![(name, Values::Switches(Vec::new()))],
        ColumnKind::Word => vec![(name, Values::Words(Words::default()))],
        ColumnKind::Value => {
            vec![(name, Values::Numbers(Vec::new())), ("word", Values::Words(Words::default()))]
        }
    }
}

/// Cells of one column that are not written yet.
struct Buffer {
    values: Values,
    /// For each row 1 if it has a value, 0 if it is empty; nothing where no cell may be empty.
    levels: Vec<i16>,
}

enum Values {
    Times(Vec<i64>),
    Numbers(Vec<f64>),
    Switches(Vec<bool>),
    Words(Words),
}

/// Words that come again and again share their memory.
#[derive(Default)]
struct Words {
    known: HashMap<Arc<str>, ByteArray>,
    values: Vec<ByteArray>,
}

impl Words {
    fn push(&mut self, word: &Arc<str>) {
        let bytes = match self.known.get(word) {
            Some(bytes) => bytes.clone(),
            None => self.known.entry(word.clone()).or_insert(ByteArray::from(word.as_bytes().to_vec())).clone(),
        };
        self.values.push(bytes);
    }
}

impl Values {
    fn field(&self, name: &str) -> Result<TypePtr, ParquetError> {
        let (physical, logical) = match self {
            Self::Times(_) => (Physical::INT64, Some(LogicalType::timestamp(true, TimeUnit::MICROS))),
            Self::Numbers(_) => (Physical::DOUBLE, None),
            Self::Switches(_) => (Physical::BOOLEAN, None),
            Self::Words(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let repetition = if self.may_be_empty() { Repetition::OPTIONAL } else { Repetition::REQUIRED };
        let field = Type::primitive_type_builder(name, physical);
        Ok(Arc::new(field.with_repetition(repetition).with_logical_type(logical).build()?))
    }

    fn may_be_empty(&self) -> bool {
        !matches!(self, Self::Times(_))
    }

    /// False if the cell is not one of this column.
    fn push(&mut self, cell: &Cell) -> bool {
        match (self, cell) {
            (Self::Times(times), Cell::Time(at)) => times.push(*at),
            (Self::Times(times), _) => times.push(0),
            (Self::Numbers(numbers), Cell::Number(number)) => numbers.push(number.to_f64()),
            (Self::Numbers(numbers), Cell::Switch(on)) => numbers.push(f64::from(u8::from(*on))),
            (Self::Switches(switches), Cell::Switch(on)) => switches.push(*on),
            (Self::Words(words), Cell::Word(word) | Cell::Choice(word)) => words.push(word),
            _ => return false,
        }
        true
    }
}

impl Buffer {
    fn push(&mut self, cell: &Cell) {
        let taken = self.values.push(cell);
        if self.values.may_be_empty() {
            self.levels.push(i16::from(taken));
        }
    }

    fn write(&mut self, mut column: SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        let levels = self.values.may_be_empty().then_some(self.levels.as_slice());
        match &mut self.values {
            Values::Times(times) => {
                column.typed::<Int64Type>().write_batch(times, levels, None)?;
                times.clear();
            }
            Values::Numbers(numbers) => {
                column.typed::<DoubleType>().write_batch(numbers, levels, None)?;
                numbers.clear();
            }
            Values::Switches(switches) => {
                column.typed::<BoolType>().write_batch(switches, levels, None)?;
                switches.clear();
            }
            Values::Words(words) => {
                column.typed::<ByteArrayType>().write_batch(&words.values, levels, None)?;
                words.values.clear();
            }
        }
        self.levels.clear();
        column.close()
    }
}

fn failed(error: ParquetError) -> ExportError {
    ExportError::Write(match error {
        ParquetError::External(cause) => match cause.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(cause) => io::Error::other(cause),
        },
        error => io::Error::other(error),
    })
}
