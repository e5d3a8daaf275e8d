//! Throughput of the pure codecs.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use dcon_bench::protocol::{dcon, modbus};
use std::hint::black_box;

fn codecs(criterion: &mut Criterion) {
    let answer = dcon::encode(">+030.00+086.00+050.00+018.40+065.12", true);
    let mut group = criterion.benchmark_group("dcon");
    group.throughput(Throughput::Bytes(answer.len() as u64));
    group.bench_function("encode a command with checksum", |b| b.iter(|| dcon::encode(black_box("$01LC7C00A"), true)));
    group.bench_function("decode five channels with checksum", |b| b.iter(|| dcon::decode(black_box(&answer), true)));
    group.finish();

    let request = modbus::with_crc(&[1, 3, 0, 0, 0, 100]);
    let words: Vec<u8> = [1, 3, 200].into_iter().chain((0..200).map(|i| i as u8)).collect();
    let answer = modbus::with_crc(&words);
    let mut group = criterion.benchmark_group("modbus");
    group.throughput(Throughput::Bytes(answer.len() as u64));
    group.bench_function("check an answer of 100 registers", |b| {
        b.iter(|| modbus::check_answer(black_box(&request), black_box(&answer)))
    });
    group.finish();
}

criterion_group!(benches, codecs);
criterion_main!(benches);
