"""Prints all samples of a recording as CSV: python3 read.py RECORDING"""

import csv
import sqlite3
import sys


def numbers(data):
    """The integers of a block: seven bits in each byte, lowest first."""
    number = shift = 0
    for byte in data:
        number |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            yield number
            number = shift = 0


def samples(data, start, count):
    """Time in microseconds since 1970 UTC, value in units of the last decimal, 1 where samples are missing before."""
    at = step = value = 0
    left = numbers(data[start:])
    for place, time, change in zip(range(count), left, left):
        gap, time = time & 1, time >> 1
        step += (time >> 1) ^ -(time & 1)
        value += (change >> 1) ^ -(change & 1)
        at += step
        if place == 0:
            step = 0
        yield at, value, gap


def main(path):
    recording = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
    write = csv.writer(sys.stdout, lineterminator="\n").writerow
    write(["line", "module", "item", "time", "value", "gap"])
    series = recording.execute(
        "SELECT series.id, line, modules.label || '@' || address, item, decimals FROM series"
        " JOIN modules ON modules.id = module ORDER BY series.id"
    ).fetchall()
    for series_id, line, module, item, decimals in series:
        blocks = "SELECT data, start, count FROM spans JOIN blocks ON blocks.id = block WHERE series = ? ORDER BY first"
        fresh = "SELECT at, value, gap FROM fresh WHERE series = ? ORDER BY id"
        rows = [row for block in recording.execute(blocks, [series_id]) for row in samples(*block)]
        for at, value, gap in rows + recording.execute(fresh, [series_id]).fetchall():
            write([line, module, item, at, f"{value / 10**decimals:.{decimals}f}", gap])


main(sys.argv[1])
