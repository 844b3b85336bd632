"""Results as tables, arrays and verdicts by the names of grids."""

import array
import ast
import csv
import io
import json
import sys
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple, Union

from .errors import Json, OrielError
from .files import StrPath, cannot, read_json

try:
    import numpy
except ImportError:
    numpy = None  # type: ignore[assignment]

PLACE = ("x", "y", "z", "dx", "dy", "dz")  # columns of a sensor's position and direction
Interval = Tuple[Optional[float], Optional[float]]
Values = Any  # a numpy array if numpy is installed, else a list of floats


def _values(numbers: Sequence[Optional[float]]) -> Values:
    known = [float("nan") if number is None else float(number) for number in numbers]
    return known if numpy is None else numpy.array(known)


class Verdict(NamedTuple):
    """A rule or target, and whether it is met.

    verdict: "pass", "fail", "undecided" or "unknown". grid: None for all grids together. rule: None
    for the job's own targets. value and interval_95 are None where a rule has several targets.
    """

    rule: Optional[str]
    target: Optional[str]
    grid: Optional[str]
    verdict: str
    value: Optional[float]
    interval_95: Optional[Interval]
    unit: str
    note: Optional[str]

    def __str__(self) -> str:
        what = ", ".join(part for part in (self.rule, self.target) if part)
        is_named = self.grid is None or " of %s " % self.grid in what
        head = what if is_named else "%s of %s" % (what, self.grid)
        text = "%s: %s" % (head, self.verdict)
        if self.value is not None and self.interval_95:
            low, high = ("?" if one is None else "%.4g" % one for one in self.interval_95)
            text += ", %.4g %s (95 %% interval %s to %s)" % (self.value, self.unit, low, high)
        return text + ("; " + self.note if self.note else "")


class Table:
    """Rows with named columns. Iterates over rows as dicts."""

    def __init__(self, columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
        self.columns, self.rows = list(columns), [list(row) for row in rows]

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Dict[str, Any]]:
        return (dict(zip(self.columns, row)) for row in self.rows)

    def __getitem__(self, column: str) -> Values:
        """Returns a column: an array or list of numbers, or a list if it has text."""
        if column not in self.columns:
            raise KeyError("there is no column %r; there are %s" % (column, ", ".join(self.columns)))
        at = self.columns.index(column)
        cells = [row[at] for row in self.rows]
        return cells if any(isinstance(cell, str) for cell in cells) else _values(cells)

    def only(self, **cells: Any) -> "Table":
        """Returns the rows that have these values: table.only(grid="desks")."""
        return Table(self.columns, [row for row in self.rows
                                    if all(row[self.columns.index(key)] == cell for key, cell in cells.items())])

    def to_csv(self, path: StrPath) -> str:
        """Writes the table as CSV in UTF-8. Returns the path."""
        try:
            with open(path, "w", encoding="utf-8", newline="") as stream:
                writer = csv.writer(stream, lineterminator="\n")
                writer.writerow(self.columns)
                writer.writerows([["" if cell is None else cell for cell in row] for row in self.rows])
        except OSError as error:
            raise cannot("write", path, error) from error
        return str(path)


def _cell(text: str) -> Union[str, float, None]:
    try:
        return float(text) if text else None
    except ValueError:
        return text


def read_table(data: bytes) -> Table:
    """Reads a CSV of the daemon. Columns of the intervals get the name of the column before them."""
    rows = list(csv.reader(io.StringIO(data.decode("utf-8"), newline="")))
    columns: List[str] = []
    for name in rows[0]:
        owner = next((one for one in reversed(columns) if not one.endswith((" low_95", " high_95"))), "")
        columns.append("%s %s" % (owner, name) if name in ("low_95", "high_95") else name)
    is_text = [name == "grid" or name.startswith("shades of ") for name in columns]
    return Table(columns, [[cell if text else _cell(cell) for cell, text in zip(row, is_text)] for row in rows[1:]])


def read_npy(data: bytes) -> Any:
    """Reads an array of float32 in numpy's format, version 1 (NEP 1): a numpy array, or lists of rows."""
    if numpy is not None:
        return numpy.load(io.BytesIO(data), allow_pickle=False)
    if data[:8] != b"\x93NUMPY\x01\x00":
        raise OrielError("the file is no array of numpy's format, version 1")
    start = 10 + int.from_bytes(data[8:10], "little")
    head = ast.literal_eval(data[10:start].decode("latin-1"))
    if head["descr"] != "<f4" or head["fortran_order"]:
        raise OrielError("the array is not of float32 by rows")
    values = array.array("f", data[start:])
    if sys.byteorder == "big":
        values.byteswap()
    shape = head["shape"]
    if len(shape) == 1:
        return values.tolist()
    return [values[row * shape[1]:(row + 1) * shape[1]].tolist() for row in range(shape[0])]


class Result(Dict[str, Json]):
    """A job's result.json as a dict, with tables, arrays and verdicts.

    Arrays are numpy's if numpy is installed, else lists. Unknown values are NaN, in rows of tables None.
    """

    def __init__(self, document: Dict[str, Json], read: Callable[[str], bytes],
                 positions: Callable[[], Dict[str, List[List[Optional[float]]]]]) -> None:
        super().__init__(document)
        self.read = read  # read(name) returns the bytes of a result file
        self._positions = positions

    @property
    def grids(self) -> List[str]:
        """Names of the grids. Sensors without a grid are one that is called "sensors"."""
        return [name for name, _, _ in self._ranges()]

    def _ranges(self) -> List[Tuple[str, int, int]]:
        if self.get("kind") == "annual":
            return [(grid["name"], 0, grid["sensors"]) for grid in self["grids"]]
        grids = self.get("grids") or []
        if not grids and "skies" in self and self["skies"]:
            grids = json.loads(self.read(self["skies"][0]["file"]).decode("utf-8")).get("grids") or []
        if grids:
            return [(grid["name"], grid["first"], grid["first"] + grid["count"]) for grid in grids]
        first = (self.get("skies") or [{}])[0].get("illuminance_lx", self.get("sensors")) or []
        return [("sensors", 0, len(first))] if first else []

    def _range_of(self, grid: Optional[str]) -> slice:
        ranges = self._ranges()
        if grid is None:
            return slice(0, ranges[-1][2] if ranges else 0)
        for name, first, end in ranges:
            if name == grid:
                return slice(first, end)
        raise OrielError("there is no grid %r" % grid, "there are " + (", ".join(self.grids) or "none"))

    # ---- One moment, or several ------------------------------------------------------------------

    def _of_sky(self, sky: Optional[str]) -> Dict[str, Json]:
        if "skies" not in self:
            return self
        skies = {one["name"]: one for one in self["skies"]}
        if sky not in skies:
            raise OrielError("a result of several skies needs the name of one", "there are " + ", ".join(skies))
        return dict(json.loads(self.read(skies[sky]["file"]).decode("utf-8")))

    def values(self, grid: Optional[str] = None, sky: Optional[str] = None) -> Values:
        """Returns illuminances in lx of a grid's sensors, or of all. sky: name of one of several skies."""
        return _values([one["illuminance_lx"] for one in self._of_sky(sky)["sensors"][self._range_of(grid)]])

    def errors(self, grid: Optional[str] = None, sky: Optional[str] = None) -> Values:
        """Returns standard errors in lx, in the same order."""
        return _values([one.get("standard_error_lx") for one in self._of_sky(sky)["sensors"][self._range_of(grid)]])

    def table(self, grid: Optional[str] = None, sky: Optional[str] = None) -> Table:
        """Returns sensors as a table: grid, position, direction, illuminance, standard error and interval.

        For a year, the table has its metrics (`metrics`). Positions come from the job's document, or
        from its sensors.csv (`heat_map`); those of a file that only the daemon has are None.
        """
        if self.get("kind") == "annual":
            return self.metrics(grid)
        document, chosen = self._of_sky(sky), self._range_of(grid)
        places = self._places(document)
        rows: List[List[Any]] = []
        for name, first, end in self._ranges():
            for index in range(max(first, chosen.start), min(end, chosen.stop)):
                sensor = document["sensors"][index]
                low, high = sensor.get("interval_95_lx") or (None, None)
                error = sensor.get("standard_error_lx")
                rows.append([name, *places[index], sensor["illuminance_lx"], error, low, high])
        return Table(("grid", *PLACE, "illuminance_lx", "standard_error_lx",
                      "low_95_lx", "high_95_lx"), rows)

    def _places(self, document: Dict[str, Json]) -> List[List[Optional[float]]]:
        """Returns position and direction of every sensor."""
        if "sensor_files" in document:
            table = read_table(self.read(document["sensor_files"]["csv"]))
            at = [table.columns.index(name) for name in PLACE]
            return [[row[column] for column in at] for row in table.rows]
        known = self._positions()
        places: List[List[Optional[float]]] = []
        for name, first, end in self._ranges():
            unknown: List[Any] = [[None] * len(PLACE)] * (end - first)
            places.extend(known.get(name, unknown))
        return places

    def glare(self, view: Optional[str] = None, sky: Optional[str] = None) -> Dict[str, Json]:
        """Returns the glare of a view: metrics, class and sources. For a year, of a seat, by its name."""
        where = self["glare"]["seats"] if self.get("kind") == "annual" else self._of_sky(sky).get("views", [])
        found = {one["name"]: one.get("glare", one) for one in where}
        if view is None and len(found) == 1:
            return dict(next(iter(found.values())))
        if view not in found:
            raise OrielError("there is no view %r" % view, "there are " + (", ".join(found) or "none"))
        return dict(found[view])

    # ---- Years -----------------------------------------------------------------------------------

    def verdicts(self, rule: Optional[str] = None, grid: Optional[str] = None) -> List[Verdict]:
        """Returns verdicts of rules and targets, with values and intervals.

        rule: only of rules that begin with it, such as "LEED". grid: only of that grid; by default
        of all grids together and of each.
        """
        found = [self._verdict(one) for one in list(self.get("rules", [])) + list(self.get("verdicts", []))]
        return [one for one in found if (rule is None or (one.rule or "").lower().startswith(rule.lower()))
                and (grid is None or one.grid == grid)]

    @staticmethod
    def _verdict(one: Dict[str, Json]) -> Verdict:
        interval = one.get("interval_95")
        return Verdict(one.get("rule"), one.get("target"), one.get("grid"), one["verdict"], one.get("value"),
                       (interval[0], interval[1]) if interval else None, one.get("unit") or "", one.get("note"))

    def figures(self, grid: Optional[str] = None) -> Table:
        """Returns the figures of a year's grid, or of all grids together: sDA, ASE, means of metrics."""
        if grid is not None:
            self._range_of(grid)
        of_all = self["all"] or self["grids"][0]["figures"]
        figures = of_all if grid is None else next(one["figures"] for one in self["grids"] if one["name"] == grid)
        return Table(("name", "when", "value", "low_95", "high_95", "unit"),
                     [[one["name"], one["when"], one["value"], *one["interval_95"], one["unit"]] for one in figures])

    def metrics(self, grid: Optional[str] = None) -> Table:
        """Returns a year's sensors with every metric and its interval (sensors.csv)."""
        if grid is not None:
            self._range_of(grid)
        table = read_table(self.read("sensors.csv"))
        return table if grid is None else table.only(grid=grid)

    def hours(self) -> Table:
        """Returns the hours of a year: light outside, means of the grids, states of shades (hours.csv)."""
        return read_table(self.read("hours.csv"))

    def hourly(self, grid: str, state: str = "default", light: str = "total") -> Any:
        """Returns illuminances in lx, sensors by hours with light. The job needs "honeybee" in `formats`.

        light: "total", "direct" or "se" (standard errors). `sun_up_hours` has the hours.
        """
        self._range_of(grid)
        names = {one["name"]: one["full_id"] if "identifier" not in one else one["identifier"]
                 for one in json.loads(self.read("results/grids_info.json").decode("utf-8"))}
        return read_npy(self.read("results/__static_apertures__/%s/%s/%s.npy" % (state, light, names[grid])))

    def sun_up_hours(self) -> Values:
        """Returns the hours with light, as hours from the start of the year to the middle of each."""
        return _values([float(line) for line in self.read("results/sun-up-hours.txt").decode("ascii").split()])


def load_result(folder: StrPath) -> Result:
    """Returns the result in a folder that Job.fetch or `oriel fetch` has filled."""
    top = Path(folder)

    def read(name: str) -> bytes:
        try:
            return (top / name).read_bytes()
        except OSError as error:
            raise cannot("read", top / name, error) from error

    return Result(read_json(top / "result.json"), read, dict)
