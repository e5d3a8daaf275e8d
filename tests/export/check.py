"""Reads a recording and its exports with Python's own csv, json and sqlite3, and Parquet with pyarrow where it is
installed: all say the same, and what the simulated modules were.

usage: check.py RECORDING FOLDER COURSES
"""

import csv
import json
import sqlite3
import sys
from datetime import datetime, timedelta, timezone
from decimal import Decimal
from itertools import islice
from pathlib import Path

recording, folder, courses = sys.argv[1], Path(sys.argv[2]), json.loads(Path(sys.argv[3]).read_text("utf-8"))
EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


def micros(text):
    """Microseconds since 1970 of a time in ISO 8601, which has to have an offset."""
    at = datetime.fromisoformat(text)
    assert at.tzinfo is not None, text
    return (at - EPOCH) // timedelta(microseconds=1)


def table(name):
    with open(folder / name, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert all(len(row) == len(rows[0]) for row in rows), name
    return rows[0], rows[1:]


def objects(name):
    with open(folder / name, encoding="utf-8") as file:
        return [json.loads(line, parse_float=Decimal, parse_int=Decimal) for line in file]


def text(value):
    """A value of JSON as CSV has it."""
    return str(value).lower() if isinstance(value, bool) else "" if value is None else str(value)


def same(what, one, other):
    assert len(one) == len(other), f"{what}: {len(one)} and {len(other)} rows"
    for place, (a, b) in enumerate(zip(one, other)):
        assert a == b, f"{what}, row {place}: {a} and {b}"
    print(f"{what}: {len(one)} rows agree")


def numbers(data):
    """The numbers of a block: groups of seven bits, lowest first."""
    number = shift = 0
    for byte in data:
        number |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            yield number
            number = shift = 0


def signed(number):
    return number >> 1 if number % 2 == 0 else -(number >> 1) - 1


def samples_of(data):
    """The samples of a span as the schema describes them: time, value, gap."""
    at = step = value = 0
    parts = numbers(data)
    for place, (time, change) in enumerate(zip(parts, parts)):
        distance = step + signed(time >> 1)
        at, value = at + distance, value + signed(change)
        step = 0 if place == 0 else distance
        yield at, value, time & 1


def recorded():
    """All samples of the recording, as the export with one row for each sample has them."""
    database = sqlite3.connect(f"file:{recording}?mode=ro", uri=True)
    assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    samples = []
    series = database.execute(
        "SELECT series.id, modules.label || '@' || address, item, unit, kind, decimals, words FROM series"
        " JOIN modules ON modules.id = module"
    )
    for place, (number, module, item, unit, kind, decimals, words) in enumerate(series.fetchall()):
        of_series = list(database.execute("SELECT at, value, gap FROM fresh WHERE series = ?", [number]))
        query = "SELECT data, start, count FROM spans JOIN blocks ON blocks.id = spans.block WHERE series = ?"
        for data, start, count in database.execute(query, [number]):
            span = list(islice(samples_of(data[start:]), count))
            assert len(span) == count, f"{module} {item}: {len(span)} samples instead of {count}"
            of_series += span
        assert len({at for at, _, _ in of_series}) == len(of_series), f"{module} {item}: a sample stands there twice"
        for at, value, gap in of_series:
            if kind == "number":
                value = str(Decimal(value).scaleb(-decimals))
            elif kind == "switch":
                value = "true" if value else "false"
            else:
                value = json.loads(words)[value]
            samples.append((at, place, [at, module, item, value, unit, "true" if gap else "false"]))
    samples.sort(key=lambda sample: sample[:2])
    events = database.execute(
        "SELECT at, label || '@' || address, kind, text FROM events LEFT JOIN modules ON modules.id = module"
    )
    return [row for _, _, row in samples], [[part or "" for part in event] for event in events]


header, rows = table("time.csv")
assert header[0] == "time"
for name, course in courses.items():
    cells = [row[header.index(name)] for row in rows]
    cells = [cell for cell in cells if cell]
    changes = [cell for place, cell in enumerate(cells) if place == 0 or cell != cells[place - 1]]
    assert changes == course, f"{name}: {changes}, but the module was {course}"
times = [micros(row[0]) for row in rows]
assert times == sorted(set(times))
print(f"time.csv: {len(courses)} courses are those of the modules")

same("time.jsonl", [[text(row.get(name)) for name in header] for row in objects("time.jsonl")], rows)
sample_header, samples = table("sample.csv")
as_cells = [[text(row.get(name)) for name in sample_header] for row in objects("sample.jsonl")]
for cells in as_cells:
    cells[0] = micros(cells[0])
for cells in samples:
    cells[0] = micros(cells[0])
same("sample.jsonl", as_cells, samples)
stored, happened = recorded()
same("sqlite3, samples", stored, samples)
_, events = table("events.csv")
same("sqlite3, events", sorted(happened), sorted([micros(event[0])] + event[1:4] for event in events))
same("events.jsonl", [event["text"] for event in objects("events.jsonl")], [event[3] for event in events])

try:
    import pyarrow
    import pyarrow.parquet
except ImportError:
    print("Parquet: skipped, as pyarrow is not installed")
    sys.exit()


def parquet(name):
    file = pyarrow.parquet.read_table(folder / name)
    assert file.schema.field("time").type == pyarrow.timestamp("us", tz="UTC"), file.schema
    assert file.schema.metadata[b"program"] == b"dcon-bench", file.schema.metadata
    return file


file = parquet("time.parquet")
assert file.column_names == header
of_type = {"double": float, "bool": lambda cell: cell == "true", "string": str}
columns = [file.column("time").cast(pyarrow.int64()).to_pylist()]
expected = [[micros(row[0]) for row in rows]]
for place, name in enumerate(header[1:], 1):
    column = file.column(name)
    columns.append(column.to_pylist())
    read = of_type[str(column.type)]
    expected.append([read(row[place]) if row[place] else None for row in rows])
same("time.parquet", list(zip(*columns)), list(zip(*expected)))

file = parquet("sample.parquet")
found = zip(file.column("time").cast(pyarrow.int64()).to_pylist(), *(file.column(name).to_pylist() for name in file.column_names[1:]))
as_number = {"true": 1.0, "false": 0.0}
is_number = lambda cell: cell.lstrip("-").replace(".", "").isdigit()
expected = [
    (
        at,
        module,
        item,
        as_number.get(value, float(value) if is_number(value) else None),
        None if value in as_number or is_number(value) else value,
        unit or None,
        gap == "true",
    )
    for at, module, item, value, unit, gap in samples
]
same("sample.parquet", list(found), expected)
