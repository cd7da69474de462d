"""Datasets of `swingbank generate` as lazy arrays with names and units."""
from __future__ import annotations

import json
import os
import pathlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError


class Array:
    """A lazy array over all shards: an index reads only the rows that it selects. Axes are named."""

    def __init__(self, dataset: Dataset, path: str, column: int | None, axes: tuple[str, ...], unit: str) -> None:
        self._dataset, self._path, self._column = dataset, path, column
        self.axes = axes
        self.unit = unit
        full = dataset._shape(path)
        self.shape: tuple[int, ...] = full if column is None else full[:1] + full[2:]

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the values; records that are stored as 16-bit integers are converted to float32."""
        return self._dataset._dtype(self._path)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, index: Any) -> NDArray[Any]:
        rows, *rest = index if isinstance(index, tuple) else (index,)
        values = self._dataset._read(self._path, rows, self._column)
        if not rest:
            return values
        chosen: NDArray[Any] = values[tuple(rest) if isinstance(rows, (int, np.integer)) else (slice(None), *rest)]
        return chosen

    def __array__(self, dtype: Any = None) -> NDArray[Any]:
        values = self[:]
        return values if dtype is None else values.astype(dtype)

    def __repr__(self) -> str:
        sizes = ", ".join(f"{axis}: {size}" for axis, size in zip(self.axes, self.shape))
        return f"<swingbank.Array {self._path} ({sizes}) [{self.unit}]>"


class Dataset:
    """A dataset folder. `dataset["P"]` is a channel, rows x samples; `dataset.parameters["H"]` a parameter, rows.

    Attributes: `channels` and `parameter_units` map names to units; `t` [s], shape (samples,); `rate` [1/s];
    `machine_model`; `header`, the content of dataset.json. Channel values in pu are on each machine's base.
    Raises InputError if the folder holds no complete dataset.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.path = pathlib.Path(folder)
        self.header: dict[str, Any] = self._read_header()
        self.channels: dict[str, str] = dict(zip(self.header["channel_names"], self.header["channel_units"]))
        self.parameter_units: dict[str, str] = dict(
            zip(self.header["parameter_names"], self.header["parameter_units"]))
        self.rate = float(self.header["rate"])
        self.machine_model = str(self.header["machine_model"])
        self.t: NDArray[np.float64] = np.arange(int(self.header["samples"])) / self.rate
        self._file: Any = None
        self._open()

    def _read_header(self) -> dict[str, Any]:
        file = self.path / "dataset.json"
        try:
            header = json.loads(file.read_text())
        except OSError as error:
            raise InputError([("no dataset", str(file), error.strerror or str(error),
                               "give a folder that `swingbank generate` wrote")]) from None
        except ValueError:
            raise InputError([("no dataset", str(file), "the file is not JSON",
                               "make the dataset again with swingbank generate")]) from None
        if not str(header.get("format", "")).startswith("swingbank-dataset-"):
            raise InputError([("no dataset", str(file), f"its format is {header.get('format')!r}",
                               "give a folder that `swingbank generate` wrote")])
        return dict(header)

    def _open(self) -> Any:
        if self._file is None:
            import h5py  # type: ignore[import]  # needs 0.2 s, and only datasets need it

            file = self.path / "dataset.h5"
            if not file.exists():
                raise InputError([("incomplete dataset", str(file), "its virtual file of all shards is missing",
                                   "run the same swingbank generate again to finish it")])
            self._file = h5py.File(file, "r")
        return self._file

    def close(self) -> None:
        """Closes the files; a later access opens them again."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def __enter__(self) -> Dataset:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __getstate__(self) -> dict[str, Any]:
        """Omits the open file when pickled, so that each process of a data loader opens the files itself."""
        return {**self.__dict__, "_file": None}

    def _shape(self, path: str) -> tuple[int, ...]:
        return tuple(int(size) for size in self._open()[path].shape)

    def _dtype(self, path: str) -> np.dtype[Any]:
        stored: np.dtype[Any] = self._open()[path].dtype
        return np.dtype(np.float32) if path == "records" and stored == np.int16 else stored

    def _read(self, path: str, rows: Any, column: int | None) -> NDArray[Any]:
        array = self._open()[path]
        index = rows if column is None else (rows, column)
        values: NDArray[Any] = np.asarray(array[index])
        if path != "records" or array.dtype != np.int16:
            return values
        scale = np.asarray(self._open()["record_scale"][index], dtype=np.float64)
        converted: NDArray[np.float32] = (scale[..., :1] + scale[..., 1:] * values).astype(np.float32)
        return converted

    def __len__(self) -> int:
        return self._shape("records")[0]

    @property
    def records(self) -> Array:
        """All channels, shape (rows, channels, samples), in the units of `channels`."""
        return Array(self, "records", None, ("row", "channel", "sample"), "see channels")

    def __getitem__(self, channel: str) -> Array:
        """Returns one channel, shape (rows, samples)."""
        if channel not in self.channels:
            raise KeyError(channel)
        return Array(self, "records", list(self.channels).index(channel), ("row", "sample"), self.channels[channel])

    @property
    def parameters(self) -> dict[str, Array]:
        """Parameters by name, shape (rows,) each."""
        return {name: Array(self, "parameters", k, ("row",), unit)
                for k, (name, unit) in enumerate(self.parameter_units.items())}

    @property
    def parameter_matrix(self) -> Array:
        """All parameters, shape (rows, parameters), in the units of `parameter_units`."""
        return Array(self, "parameters", None, ("row", "parameter"), "see parameter_units")

    @property
    def generator(self) -> Array:
        """Bus number of each row's generator, shape (rows,)."""
        return Array(self, "generator", None, ("row",), "-")

    @property
    def sample_id(self) -> Array:
        """Number of each row's draw, shape (rows,)."""
        return Array(self, "sample_id", None, ("row",), "-")

    def __repr__(self) -> str:
        return (f"<swingbank.Dataset {self.path.name}: {len(self)} rows of {self.machine_model}, "
                f"{len(self.channels)} channels, {len(self.t)} samples at {self.rate:g}/s>")

    def _repr_html_(self) -> str:
        def table(title: str, rows: dict[str, str]) -> str:
            cells = "".join(f"<tr><td>{name}</td><td>{unit}</td></tr>" for name, unit in rows.items())
            return f"<table><caption>{title}</caption><tr><th>name</th><th>unit</th></tr>{cells}</table>"

        return (f"<div><p>{len(self)} rows of {self.machine_model}, {len(self.t)} samples at {self.rate:g}/s</p>"
                + table("channels", self.channels) + table("parameters", self.parameter_units) + "</div>")
