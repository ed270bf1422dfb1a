/* Columns of a run, as the page holds them: typed arrays, read from base 64 once. */
globalThis.view = { data: JSON.parse(document.getElementById("data").textContent) };
view.unpacked = rub.unpacked;

/** A group: its columns as arrays, with units and meanings beside them. */
view.columns = (packed) => {
  const found = { units: {}, means: {} };
  for (const [name, column] of Object.entries(packed)) {
    found[name] = view.unpacked(column);
    found.units[name] = column.units;
    found.means[name] = column.means;
  }
  return found;
};

/** A column of lives: float32 numbers behind a base for each chunk, one number for all, or plain numbers. */
const unfolded = ({ chunk, bases, behind, value, values }, count) => {
  if (values) return Float64Array.from(view.unpacked(values));
  if (value !== undefined) return new Float64Array(count).fill(value);
  const begin = view.unpacked(bases);
  return Float64Array.from(view.unpacked(behind), (value, row) => begin[Math.floor(row / chunk)] + value);
};

/** Every life of the page as columns, with what follows from birth and diameter: deaths, areas, times. */
view.livesOf = ({ units, rows, first, columns, marked }, areaAtMiddle, speed) => {
  const found = { units: { ...units } };
  const count = view.unpacked(columns.birth_distance.behind).length;
  for (const [name, column] of Object.entries(columns)) found[name] = unfolded(column, count);
  const { birth_distance: birth, diameter, lateral_offset: aside } = found;
  found.junction = rows ? view.unpacked(rows) : Uint32Array.from({ length: count }, (_, row) => first + row);
  const half = diameter.map((d, row) => rub.halfLife(d, aside ? aside[row] : 0));
  found.life_distance = half.map((length) => 2 * length);
  found.death_distance = birth.map((s, row) => s + found.life_distance[row]);
  found.max_area ??= diameter.map((d, row) => areaAtMiddle(half[row], d, aside ? aside[row] : 0));
  found.state = new Uint8Array(count);
  const [death, state] = [view.unpacked(marked.death), view.unpacked(marked.state)];
  view.unpacked(marked.row).forEach((row, i) => {
    found.state[row] = state[i];
    found.death_distance[row] = death[i];
    if (state[i] & 4 || found.max_overlap) found.life_distance[row] = death[i] - birth[row];
  });
  for (const [time, place] of [["birth_time", birth], ["death_time", found.death_distance]]) {
    if (time in found || !(time in units)) continue;
    if (speed) found[time] = place.map((s) => s / speed);
    else delete found.units[time];
  }
  return found;
};

/** A number to seven digits, as the commands print it. */
view.number = (value) => {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "nan" : value > 0 ? "inf" : "-inf";
  if (value === 0) return "0";
  const [digits, power] = value.toExponential(6).split("e");
  const exponent = Number(power);
  const plain = (text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);
  if (exponent < -4 || exponent >= 7) {
    return `${plain(digits)}e${exponent < 0 ? "-" : "+"}${String(Math.abs(exponent)).padStart(2, "0")}`;
  }
  return plain(value.toFixed(Math.max(0, 6 - exponent)));
};

view.grouped = (value) => Math.round(value).toLocaleString("en-GB");
