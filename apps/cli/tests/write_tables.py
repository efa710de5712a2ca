"""Writes images as tables of Parquet in the way of Hugging Face, and in the folder `kinds` beside it as tables with columns of
every kind, in all the ways that pyarrow writes them.

    write_tables.py FOLDER PICTURE...
"""

import os
import sys
from datetime import date, datetime, time, timedelta
from decimal import Decimal
from pathlib import Path

os.environ["HF_HUB_OFFLINE"] = "1"
import datasets
import pyarrow as pa
from pyarrow.parquet import SortingColumn, write_table

folder, pictures = Path(sys.argv[1]), sys.argv[2:]
folder.mkdir(parents=True)
features = datasets.Features(
    {
        "image": datasets.Image(),
        "label": datasets.ClassLabel(names=["fish", "reef"]),
        "objects": datasets.Sequence({"bbox": datasets.Sequence(datasets.Value("float32"), length=4), "id": datasets.Value("int64")}),
        "caption": datasets.Value("string"),
    }
)
for split, chosen in (("train", pictures[1:]), ("test", pictures[:1])):
    rows = {
        "image": [{"bytes": Path(path).read_bytes(), "path": Path(path).name} for path in chosen],
        "label": [number % 2 for number in range(len(chosen))],
        "objects": [{"bbox": [[1.5, 2, 3, 4]] * number, "id": list(range(number))} for number in range(len(chosen))],
        "caption": [None if number % 2 else f"picture {number}" for number in range(len(chosen))],
    }
    datasets.Dataset.from_dict(rows, features=features).to_parquet(folder / f"{split}-00000-of-00001.parquet")

number = len(pictures)
columns = {
    "small": pa.array(range(number), pa.int8()),
    "unsigned": pa.array(range(number), pa.uint16()),
    "single": pa.array([1.5] * number, pa.float32()),
    "half": pa.array([1.5] * number, pa.float64()).cast(pa.float16()),
    "decimal": pa.array([Decimal("1.23")] * number, pa.decimal128(10, 2)),
    "wide": pa.array([Decimal("1.23")] * number, pa.decimal256(50, 2)),
    "moment": pa.array([datetime(2020, 1, 1)] * number, pa.timestamp("us", "UTC")),
    "time": pa.array([time(1, 2)] * number, pa.time64("us")),
    "day": pa.array([date(2020, 1, 1)] * number),
    "span": pa.array([timedelta(1)] * number),
    "flag": pa.array([True, False, None, *[True] * number][:number]),
    "flags": pa.array([[True, False]] * number, pa.list_(pa.bool_())),
    "map": pa.array([[("a", 1)]] * number, pa.map_(pa.string(), pa.int32())),
    "choice": pa.array(["x", "y", *["x"] * number][:number]).dictionary_encode(),
    "text": pa.array(["a"] * number, pa.large_string()),
    "none": pa.nulls(number),
    "mark": pa.array([b"abcd"] * number, pa.binary(4)),
    "nested": pa.array([[{"bbox": [1.0, 2.0], "names": ["fish", None]}]] * number),
}
ways = [
    {},
    {"version": "1.0", "compression": "zstd"},
    {"version": "2.6", "data_page_version": "2.0", "compression": "none"},
    {"write_page_index": True, "write_page_checksum": True, "sorting_columns": [SortingColumn(2)], "row_group_size": 2},
    {"store_decimal_as_integer": True, "use_dictionary": False, "store_schema": False, "compression": "lz4"},
    {"use_dictionary": ["text"], "column_encoding": {"small": "DELTA_BINARY_PACKED", "single": "BYTE_STREAM_SPLIT"}},
]
kinds = folder.with_name("kinds")
kinds.mkdir()
cells = pa.struct([("bytes", pa.binary()), ("path", pa.string())])
for way, options in enumerate(ways):
    images = [{"bytes": Path(path).read_bytes(), "path": f"{way}-{row}.png"} for row, path in enumerate(pictures)]
    table = pa.table({"image": pa.array(images, cells), **columns})
    write_table(table, kinds / f"{way}.parquet", **options)
