"""A run folder as numpy arrays. Needs numpy and h5py."""

import csv
import json
import os
import re
from pathlib import Path

os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")  # a run that is still going may be looked at

import h5py  # noqa: E402
import numpy as np  # noqa: E402


def read_csv(path):
    """{column with unit: array}; a last row that is still being written is left out."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    header, body = rows[0], [row for row in rows[1:] if len(row) == len(rows[0])]
    values = np.array([[float(cell) for cell in row] for row in body]).reshape(len(body), len(header))
    return {name: values[:, k] for k, name in enumerate(header)}


def split_unit(column):
    """('block.x', 'm') from 'block.x [m]'."""
    name, _, unit = column.partition(" [")
    return name, unit.rstrip("]")


def joined(tables):
    """Tables that a later stage continued with other columns (reactions-2 ...) behind the first; nan where absent."""
    whole = {}
    for name in sorted(tables, key=lambda name: (len(name), name)):
        first, table = re.sub(r"-\d+$", "", name), tables[name]
        if first not in whole:
            whole[first] = table
            continue
        before, rows = whole[first], len(next(iter(table.values())))
        for column in dict.fromkeys([*before, *table]):
            count = len(next(iter(whole[first].values())))
            old = whole[first].get(column, np.full(count, np.nan))
            before = {**before, column: np.concatenate([old, table.get(column, np.full(rows, np.nan))])}
        whole[first] = before
    return whole


FORCE_WINDOW = 4e-3  # s; the force on a block is always given with this centred mean beside it


def centred_mean(time, mean, window=FORCE_WINDOW):
    """Mean over a window round each time, shorter at both ends; mean: of the interval that ends at each time."""
    integral = np.concatenate([[0.0], np.cumsum(mean[1:] * np.diff(time))])
    low, high = (np.clip(time + side * window / 2, time[0], time[-1]) for side in (-1, 1))
    span, change = high - low, np.interp(high, time, integral) - np.interp(low, time, integral)
    return np.where(span > 0, change / np.where(span > 0, span, 1), mean)


def with_filtered_force(table):
    """A block's history with the filtered vertical force."""
    if "force_filtered [N]" in table or "force_mean.z [N]" not in table or len(table["time [s]"]) == 0:
        return table
    return {**table, "force_filtered [N]": centred_mean(table["time [s]"], table["force_mean.z [N]"])}


class Run:
    """summary: dict; histories: {"energy": {column: array}}; states through state()."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.h5_path = self.folder / "results.h5"
        summary = self.folder / "summary.json"
        self.summary = json.loads(summary.read_text(encoding="utf-8")) if summary.exists() else {}
        tables = {path.stem: read_csv(path) for path in self.folder.glob("*.csv")}
        self.histories = joined(tables)
        if "block" in self.histories:
            self.histories["block"] = with_filtered_force(self.histories["block"])

    @property
    def title(self):
        return self.summary.get("title") or self.summary.get("scene") or self.folder.name

    @property
    def model(self):
        return self.summary.get("model", "")

    def history(self, name, column):
        """One column by its name with or without unit. KeyError names what there is."""
        table = self.histories[name]
        for full, values in table.items():
            if column in (full, split_unit(full)[0]):
                return values
        raise KeyError(f"{name}.csv has no column '{column}'; it has: {', '.join(table)}")

    def state_times(self):
        if not self.h5_path.exists():
            return np.empty(0)
        with h5py.File(self.h5_path, "r") as file:
            return file["states/time"][:]

    def state(self, part, index=-1):
        """Every array of /grains, /mesh, /interface or /block, those of one state included; {} when there is none."""
        count = len(self.state_times())
        if count == 0:
            return {}
        index = range(count)[index]
        with h5py.File(self.h5_path, "r") as file:
            if part not in file:
                return {}
            group = file[part]
            arrays = {name: item[()] for name, item in group.items() if isinstance(item, h5py.Dataset)}
            arrays.update({name: item[()] for name, item in group.get(f"state_{index:06d}", {}).items()})
            return arrays
