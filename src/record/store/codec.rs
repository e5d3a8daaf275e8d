//! The samples of a block as bytes: about three or four for each.
//!
//! For each sample two numbers in groups of seven bits, lowest group first, all but the last group with the highest bit
//! set (LEB128):
//!
//! 1. `zigzag(t) << 1 | gap`, where `t` of the first sample is its time, of the second its distance from the first, of
//!    every other by how much its distance from the one before differs from that one's; in microseconds.
//! 2. `zigzag(v)`, where `v` is by how much the value differs from the one before, 0 for the first (modulo 2^64).
//!
//! `zigzag` takes 0, -1, 1, -2 to 0, 1, 2, 3. A gap is 1 where samples are missing before this one.

use super::super::trend::{BLOCK, Micros, Sample};

/// Times beyond this find no room beside the gap's bit: the year 38 000.
const LATEST: Micros = 1 << 60;

/// Whether a time can be written at all.
pub fn is_time(at: Micros) -> bool {
    (-LATEST..LATEST).contains(&at)
}

/// `samples` as a block; each is later than the one before and [`is_time`].
pub fn encode(samples: &[Sample]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(samples.len().saturating_mul(4));
    let (mut at, mut step, mut value): (Micros, Micros, i64) = (0, 0, 0);
    for (place, sample) in samples.iter().enumerate() {
        let distance = sample.at.wrapping_sub(at);
        let change = distance.wrapping_sub(step);
        put(&mut bytes, zigzag(change) << 1 | u64::from(sample.gap));
        put(&mut bytes, zigzag(sample.value.wrapping_sub(value)));
        step = if place == 0 { 0 } else { distance };
        (at, value) = (sample.at, sample.value);
    }
    bytes
}

/// So many samples of the block that begins here; `None` if it is damaged.
pub fn decode(bytes: &[u8], count: usize) -> Option<Vec<Sample>> {
    let (mut samples, mut rest): (Vec<Sample>, _) = (Vec::with_capacity(count.min(BLOCK)), bytes);
    let (mut at, mut step, mut value): (Micros, Micros, i64) = (0, 0, 0);
    while samples.len() < count {
        let (time, after) = take(rest)?;
        let (change, after) = take(after)?;
        rest = after;
        let distance = step.wrapping_add(unzigzag(time >> 1));
        let next = at.wrapping_add(distance);
        let first = samples.is_empty();
        if samples.len() >= BLOCK || !is_time(next) || (!first && next <= at) {
            return None;
        }
        step = if first { 0 } else { distance };
        (at, value) = (next, value.wrapping_add(unzigzag(change)));
        samples.push(Sample { at, value, gap: time & 1 == 1 });
    }
    Some(samples)
}

fn zigzag(number: i64) -> u64 {
    ((number << 1) ^ (number >> 63)) as u64
}

fn unzigzag(number: u64) -> i64 {
    (number >> 1) as i64 ^ -((number & 1) as i64)
}

fn put(bytes: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

fn take(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let mut number = 0u64;
    for (place, byte) in bytes.iter().enumerate().take(10) {
        let group = u64::from(byte & 0x7f);
        let shift = u32::try_from(place).ok()?.checked_mul(7)?;
        if shift == 63 && group > 1 {
            return None;
        }
        number |= group << shift;
        if byte & 0x80 == 0 {
            return Some((number, bytes.get(place.checked_add(1)?..)?));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn samples() -> impl Strategy<Value = Vec<Sample>> {
        let step = (1i64..5_000_000_000, any::<i64>(), any::<bool>());
        (-1i64 << 59..1 << 59, proptest::collection::vec(step, 0..BLOCK)).prop_map(|(start, steps)| {
            let later = |at: &mut Micros, (step, value, gap)| {
                *at += step;
                Some(Sample { at: *at, value, gap })
            };
            steps.into_iter().scan(start, later).collect()
        })
    }

    #[test]
    fn a_regular_reading_takes_two_bytes_for_each_sample() {
        let samples: Vec<Sample> = (0..512)
            .map(|i| Sample { at: 1_790_000_000_000_000 + i * 1_000_000, value: 2_500 + i % 3, gap: false })
            .collect();
        assert!(encode(&samples).len() < 1_045, "{}", encode(&samples).len());
    }

    proptest! {
        #[test]
        fn samples_come_out_as_they_went_in(samples in samples()) {
            let mut bytes = encode(&samples);
            bytes.push(0x55);
            prop_assert_eq!(decode(&bytes, samples.len()), Some(samples));
        }

        #[test]
        fn any_bytes_are_samples_in_order_or_refused(
            bytes in proptest::collection::vec(any::<u8>(), 0..2_000), count in 0usize..600,
        ) {
            if let Some(samples) = decode(&bytes, count) {
                prop_assert_eq!(samples.len(), count);
                prop_assert!(samples.is_sorted_by(|earlier, later| earlier.at < later.at));
            }
        }

        #[test]
        fn a_block_that_was_cut_is_refused(samples in samples(), part in 0.0f64..1.0) {
            let bytes = encode(&samples);
            let cut = &bytes[..(bytes.len() as f64 * part) as usize];
            prop_assert!(samples.is_empty() || decode(cut, samples.len()).is_none());
        }
    }
}
