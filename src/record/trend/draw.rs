//! What to draw of a trend: of each column of the picture at most the lowest and the highest sample.

use super::block::{Columns, GROUPS};
use super::node::Node;
use super::{FAN, LEVELS, Micros, Point, Sample, Trend, micros, seconds};

impl Trend {
    /// What to draw between two times, one line for each unbroken stretch; of each of `columns` equal spans at most its
    /// lowest and highest sample, in order of time, so that no peak is hidden. One sample beyond each end is included, so
    /// that lines reach the edges. A gap narrower than a column is not seen; of samples that are on the disk only the
    /// lowest and highest are drawn until they are there.
    ///
    /// The cost depends on `columns`, not on the number of samples.
    pub fn lines(&self, from: f64, to: f64, columns: usize) -> Vec<Vec<Point>> {
        let (from, to) = (micros(from), micros(to).max(micros(from)));
        let width = to.saturating_sub(from) as f64 / columns.max(1) as f64;
        self.look();
        let mut pen = Pen::new(self, from, width);
        // Where the neighbour is on the disk only, the line reaches the edge later.
        if let Ok(Some(before)) = self.sample_before(from) {
            pen.sample(before);
        }
        let top = self.levels.last().map_or(0, Vec::len);
        let begin = self.levels.last().map_or(0, |nodes| nodes.partition_point(|node| node.last < from));
        let mut walk = Walk { trend: self, from, to, width, pen: &mut pen };
        for index in begin..top {
            if !walk.visit(LEVELS, index) {
                break;
            }
        }
        if let Ok(Some(after)) = self.sample_from(to.saturating_add(1)) {
            pen.sample(after);
        }
        pen.finish()
    }

    pub(super) fn node(&self, level: usize, index: usize) -> Option<&Node> {
        match level.checked_sub(1) {
            Some(level) => self.levels.get(level)?.get(index),
            None => self.blocks.get(index).map(|block| &block.node),
        }
    }
}

/// Goes down to where a stretch is no wider than a column.
struct Walk<'a, 'b> {
    trend: &'a Trend,
    from: Micros,
    to: Micros,
    /// Of a column, in microseconds.
    width: f64,
    pen: &'b mut Pen,
}

impl Walk<'_, '_> {
    /// False when the end is reached.
    fn visit(&mut self, level: usize, index: usize) -> bool {
        let Some(node) = self.trend.node(level, index) else { return false };
        if node.first > self.to {
            return false;
        }
        if node.last < self.from {
            return true;
        }
        if node.width() as f64 <= self.width {
            self.pen.node(node);
            return true;
        }
        let Some(below) = level.checked_sub(1) else {
            self.block(index);
            return true;
        };
        let children = index.saturating_mul(FAN)..index.saturating_add(1).saturating_mul(FAN);
        for child in children {
            if !self.visit(below, child) {
                return false;
            }
        }
        true
    }

    fn block(&mut self, index: usize) {
        let Some(block) = self.trend.blocks.get(index) else { return };
        block.used.set(self.trend.looks());
        if let Some(samples) = &block.samples {
            return self.samples(samples);
        }
        let enough = block.sketch.as_ref().is_some_and(|sketch| sketch.is_fine_enough(self.width));
        if !enough {
            self.trend.want(index, block.sketch.is_none() && block.is_coarse_enough(self.width));
        }
        match &block.sketch {
            Some(sketch) => sketch.iter().flatten().for_each(|sample| self.pen.sample(sample)),
            None => self.pen.node(&block.node),
        }
    }

    fn samples(&mut self, samples: &Columns) {
        let begin = samples.count_before(self.from);
        let end = samples.count_before(self.to.saturating_add(1));
        let mut index = begin;
        while index < end {
            match self.group(samples, index, end) {
                Some(([first, second], next)) => {
                    self.pen.sample(first);
                    self.pen.sample(second);
                    index = next;
                }
                None => {
                    samples.get(index).into_iter().for_each(|sample| self.pen.sample(sample));
                    index = index.saturating_add(1);
                }
            }
        }
    }

    /// The extremes of the largest group that begins at `index`, ends before `end` and is no wider than a column, and
    /// where the next one begins.
    fn group(&self, samples: &Columns, index: usize, end: usize) -> Option<([Sample; 2], usize)> {
        for (place, size) in GROUPS.into_iter().enumerate().rev() {
            let next = index.saturating_add(size);
            if !index.is_multiple_of(size) || next > end {
                continue;
            }
            let (first, last) = (samples.offset(index)?, samples.offset(next.saturating_sub(1))?);
            if f64::from(last.saturating_sub(first)) > self.width {
                continue;
            }
            let [earlier, later] = samples.extremes(place, index / size)?;
            // Gaps within a column are not seen; one before it is.
            let gap = samples.get(index)?.gap;
            return Some(([Sample { gap, ..earlier }, Sample { gap: false, ..later }], next));
        }
        None
    }
}

/// The lowest and highest of a column so far.
#[derive(Clone, Copy)]
struct Column {
    number: i64,
    low: (Micros, i64),
    high: (Micros, i64),
}

struct Pen {
    from: Micros,
    width: f64,
    scale: f64,
    lines: Vec<Vec<Point>>,
    line: Vec<Point>,
    column: Option<Column>,
    last: Micros,
}

impl Pen {
    fn new(trend: &Trend, from: Micros, width: f64) -> Self {
        let (lines, line) = (Vec::new(), Vec::new());
        Self { from, width, scale: trend.scale(), lines, line, column: None, last: Micros::MIN }
    }

    fn node(&mut self, node: &Node) {
        let (first, last) = if node.low_first { (node.low, node.high) } else { (node.high, node.low) };
        self.sample(Sample { at: node.first, value: first, gap: node.gap });
        self.sample(Sample { at: node.last, value: last, gap: false });
    }

    fn sample(&mut self, sample: Sample) {
        let Sample { at, value, gap } = sample;
        if gap && at.saturating_sub(self.last) as f64 >= self.width {
            self.lift();
        }
        self.last = at;
        let number =
            if self.width > 0.0 { (at.saturating_sub(self.from) as f64 / self.width).floor() as i64 } else { at };
        match &mut self.column {
            Some(column) if column.number == number => {
                if value < column.low.1 {
                    column.low = (at, value);
                }
                if value > column.high.1 {
                    column.high = (at, value);
                }
            }
            _ => {
                self.end_column();
                self.column = Some(Column { number, low: (at, value), high: (at, value) });
            }
        }
    }

    fn end_column(&mut self) {
        let Some(Column { low, high, .. }) = self.column.take() else { return };
        let (first, second) = if low.0 <= high.0 { (low, high) } else { (high, low) };
        let point = |(at, value): (Micros, i64)| [seconds(at), value as f64 / self.scale];
        self.line.push(point(first));
        if first != second {
            self.line.push(point(second));
        }
    }

    /// What follows does not continue the line.
    fn lift(&mut self) {
        self.end_column();
        if !self.line.is_empty() {
            self.lines.push(std::mem::take(&mut self.line));
        }
    }

    fn finish(mut self) -> Vec<Vec<Point>> {
        self.lift();
        self.lines
    }
}
