//! The part of Markdown that the articles use: headings, paragraphs, lists of one level, tables, fenced code; in the text
//! **bold**, `code` and [links](target). A backslash takes the meaning from the sign behind it. Everything else is text.

/// An article as a row of blocks, each of which is drawn by itself.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Document {
    pub blocks: Vec<Block>,
    /// The columns of each table.
    pub tables: Vec<Vec<Column>>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Block {
    /// Level 1 is the article's title.
    Heading(u8, Vec<Span>),
    Paragraph(Vec<Span>),
    Item(Mark, Vec<Span>),
    /// A row of the table with this index.
    Row {
        table: usize,
        head: bool,
        cells: Vec<Vec<Span>>,
    },
    Code(String),
}

/// What stands before an item of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    Bullet,
    Number(u32),
}

/// Text in one style.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Span {
    pub text: String,
    pub bold: bool,
    pub code: bool,
    /// Where a click leads.
    pub link: Option<String>,
}

/// How many characters a table's column has.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Column {
    /// In its longest word, which is not broken.
    pub word: usize,
    /// In its longest cell.
    pub cell: usize,
}

impl Block {
    /// What can be read in it.
    pub fn text(&self) -> String {
        match self {
            Self::Heading(_, spans) | Self::Paragraph(spans) | Self::Item(_, spans) => plain(spans),
            Self::Row { cells, .. } => cells.iter().map(|cell| plain(cell)).collect::<Vec<_>>().join("  "),
            Self::Code(text) => text.clone(),
        }
    }

    /// Its texts with their styles; none for code.
    pub fn spans(&self) -> impl Iterator<Item = &Span> {
        let (one, cells): (&[Span], &[Vec<Span>]) = match self {
            Self::Heading(_, spans) | Self::Paragraph(spans) | Self::Item(_, spans) => (spans, &[]),
            Self::Row { cells, .. } => (&[], cells),
            Self::Code(_) => (&[], &[]),
        };
        one.iter().chain(cells.iter().flatten())
    }
}

/// The text without its styles.
pub fn plain(spans: &[Span]) -> String {
    spans.iter().map(|span| span.text.as_str()).collect()
}

/// Text in which no sign has a meaning of its own.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        if matches!(character, '\\' | '*' | '`' | '[' | ']' | '|' | '<') {
            escaped.push('\\');
        }
        escaped.push(if character == '\n' { ' ' } else { character });
    }
    escaped
}

/// Text as code. Between bars of a table, a bar has to be escaped there too.
pub fn code(text: &str) -> String {
    format!("`{}`", text.replace('`', "'").replace('|', "\\|"))
}

pub fn parse(text: &str) -> Document {
    let mut reader = Reader::default();
    text.lines().for_each(|line| reader.take(line));
    reader.finish()
}

/// Lines that belong to one block and have not ended yet.
#[derive(Debug)]
enum Open {
    Paragraph(String),
    Item(Mark, String),
    Code(Vec<String>),
}

#[derive(Debug, Default)]
struct Reader {
    document: Document,
    open: Option<Open>,
    in_table: bool,
}

impl Reader {
    fn take(&mut self, line: &str) {
        let trimmed = line.trim();
        if let Some(Open::Code(lines)) = &mut self.open {
            if trimmed.starts_with("```") {
                self.close();
            } else {
                lines.push(line.to_owned());
            }
            return;
        }
        let row = trimmed.strip_prefix('|');
        if row.is_none() {
            self.in_table = false;
        }
        if trimmed.is_empty() {
            self.close();
        } else if trimmed.starts_with("```") {
            self.begin(Open::Code(Vec::new()));
        } else if let Some((level, text)) = heading(trimmed) {
            self.close();
            self.document.blocks.push(Block::Heading(level, spans(text)));
        } else if let Some(row) = row {
            self.close();
            self.row(row.strip_suffix('|').unwrap_or(row));
        } else if let Some((mark, text)) = item(trimmed) {
            self.begin(Open::Item(mark, text.to_owned()));
        } else {
            match &mut self.open {
                Some(Open::Paragraph(text) | Open::Item(_, text)) => {
                    text.push(' ');
                    text.push_str(trimmed);
                }
                _ => self.open = Some(Open::Paragraph(trimmed.to_owned())),
            }
        }
    }

    fn begin(&mut self, open: Open) {
        self.close();
        self.open = Some(open);
    }

    fn close(&mut self) {
        let block = match self.open.take() {
            None => return,
            Some(Open::Paragraph(text)) => Block::Paragraph(spans(&text)),
            Some(Open::Item(mark, text)) => Block::Item(mark, spans(&text)),
            Some(Open::Code(lines)) => Block::Code(lines.join("\n")),
        };
        self.document.blocks.push(block);
    }

    fn row(&mut self, text: &str) {
        let cells: Vec<Vec<Span>> = cells(text).iter().map(|cell| spans(cell.trim())).collect();
        // The line beneath a table's head.
        if self.in_table && text.chars().all(|character| matches!(character, '|' | '-' | ':' | ' ')) {
            return;
        }
        let head = !self.in_table;
        if head {
            self.document.tables.push(Vec::new());
        }
        self.in_table = true;
        let Some(columns) = self.document.tables.last_mut() else { return };
        for (index, cell) in cells.iter().enumerate() {
            if columns.len() <= index {
                columns.push(Column::default());
            }
            let text = plain(cell);
            if let Some(column) = columns.get_mut(index) {
                let word = text.split_whitespace().map(|word| word.chars().count()).max().unwrap_or_default();
                column.word = column.word.max(word);
                column.cell = column.cell.max(text.chars().count());
            }
        }
        let table = self.document.tables.len().saturating_sub(1);
        self.document.blocks.push(Block::Row { table, head, cells });
    }

    fn finish(mut self) -> Document {
        self.close();
        self.document
    }
}

fn heading(line: &str) -> Option<(u8, &str)> {
    let text = line.trim_start_matches('#');
    let level = u8::try_from(line.len().saturating_sub(text.len())).ok().filter(|level| (1..=4).contains(level))?;
    text.strip_prefix(' ').map(|text| (level, text.trim()))
}

fn item(line: &str) -> Option<(Mark, &str)> {
    if let Some(text) = line.strip_prefix("- ") {
        return Some((Mark::Bullet, text.trim()));
    }
    let (number, text) = line.split_once(". ")?;
    number.parse().ok().map(|number| (Mark::Number(number), text.trim()))
}

/// The cells of a row; an escaped bar separates none.
fn cells(row: &str) -> Vec<String> {
    let (mut cells, mut cell) = (Vec::new(), String::new());
    let mut in_code = false;
    let mut characters = row.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '|' => cells.push(std::mem::take(&mut cell)),
            '\\' if in_code => {
                let bar = characters.next_if_eq(&'|');
                cell.push(bar.unwrap_or(character));
            }
            // It is looked at once more with the styles.
            '\\' => cell.extend([character].into_iter().chain(characters.next())),
            _ => {
                in_code ^= character == '`';
                cell.push(character);
            }
        }
    }
    cells.push(cell);
    cells
}

/// The styles of a text.
fn spans(text: &str) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut span = Span::default();
    let mut rest = text;
    while let Some(character) = rest.chars().next() {
        let after = rest.get(character.len_utf8()..).unwrap_or_default();
        if let Some((inner, behind)) = after.split_once('`').filter(|_| character == '`') {
            push(&mut spans, &mut span);
            spans.push(Span { text: inner.to_owned(), bold: span.bold, code: true, link: None });
            rest = behind;
        } else if let Some(behind) = rest.strip_prefix("**") {
            push(&mut spans, &mut span);
            span.bold = !span.bold;
            rest = behind;
        } else if let Some((inner, target, behind)) = link(rest) {
            push(&mut spans, &mut span);
            spans.push(Span { text: inner.to_owned(), bold: span.bold, code: false, link: Some(target.to_owned()) });
            rest = behind;
        } else if let Some(next) = after.chars().next().filter(|next| character == '\\' && next.is_ascii_punctuation())
        {
            span.text.push(next);
            rest = after.get(next.len_utf8()..).unwrap_or_default();
        } else {
            span.text.push(character);
            rest = after;
        }
    }
    push(&mut spans, &mut span);
    spans
}

/// Ends a span; what follows has the same style.
fn push(spans: &mut Vec<Span>, span: &mut Span) {
    if !span.text.is_empty() {
        let next = Span { bold: span.bold, ..Span::default() };
        spans.push(std::mem::replace(span, next));
    }
}

/// Text, target and what follows of a link at the beginning of `text`.
fn link(text: &str) -> Option<(&str, &str, &str)> {
    let (inner, rest) = text.strip_prefix('[')?.split_once("](")?;
    let (target, rest) = rest.split_once(')')?;
    (!inner.contains('[')).then_some((inner, target, rest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(text: &str) -> Span {
        Span { text: text.to_owned(), ..Span::default() }
    }

    #[test]
    fn blocks_end_at_empty_lines_and_where_another_begins() {
        let document = parse("# Title\nOne\n  two\n\nthree\n- a\n  b\n- c\n1. d\n```\nx  y\n# z\n```\nlast");
        let expected = [
            Block::Heading(1, vec![text("Title")]),
            Block::Paragraph(vec![text("One two")]),
            Block::Paragraph(vec![text("three")]),
            Block::Item(Mark::Bullet, vec![text("a b")]),
            Block::Item(Mark::Bullet, vec![text("c")]),
            Block::Item(Mark::Number(1), vec![text("d")]),
            Block::Code("x  y\n# z".to_owned()),
            Block::Paragraph(vec![text("last")]),
        ];
        assert_eq!(document.blocks, expected);
    }

    #[test]
    fn a_table_is_a_row_of_rows_with_known_columns() {
        let document = parse("| A | B |\n|---|:--|\n| one two | `x\\|y` |\n| - | \\| |\n\n| C |\n| d |");
        let rows: Vec<(usize, bool, String)> = document
            .blocks
            .iter()
            .map(|block| match block {
                Block::Row { table, head, .. } => (*table, *head, block.text()),
                _ => panic!("{block:?}"),
            })
            .collect();
        let row = |table, head, text: &str| (table, head, text.to_owned());
        let expected = [
            row(0, true, "A  B"),
            row(0, false, "one two  x|y"),
            row(0, false, "-  |"),
            row(1, true, "C"),
            row(1, false, "d"),
        ];
        assert_eq!(rows, expected);
        assert_eq!(document.tables[0], [Column { word: 3, cell: 7 }, Column { word: 3, cell: 3 }]);
    }

    #[test]
    fn text_has_styles_and_links() {
        let bold = Span { bold: true, ..text("b") };
        let code = Span { code: true, ..text("~**") };
        let link = Span { link: Some("wiring".to_owned()), ..text("c d") };
        assert_eq!(
            spans("a **b** `~**` [c d](wiring), e"),
            [text("a "), bold, text(" "), code, text(" "), link, text(", e")]
        );
        assert_eq!(spans("open ` and [x"), [text("open ` and [x")]);
    }

    proptest! {
        #[test]
        fn escaped_text_is_read_as_it_was(given in "[ -~°–]{0,40}") {
            prop_assert_eq!(plain(&spans(&escaped(&given))), given);
        }

        #[test]
        fn escaped_cells_stay_one_cell(given in "[ -~]{0,20}") {
            let row = format!("{}|{}", escaped(&given), code(&given));
            let cells = cells(&row);
            prop_assert_eq!(cells.len(), 2);
            prop_assert_eq!(plain(&spans(&cells[0])), given.clone());
            prop_assert_eq!(plain(&spans(&cells[1])), given.replace('`', "'"));
        }

        #[test]
        fn no_text_makes_it_panic(text: String, signs in "[#|`*\\[\\]()\\\\ a1.\\n-]{0,60}") {
            parse(&text);
            parse(&signs);
        }
    }
}
