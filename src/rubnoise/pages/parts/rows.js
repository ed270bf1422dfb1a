/* Columns of a run, as the page holds them: typed arrays, read from base 64 once. */
"use strict";
const view = { data: JSON.parse(document.getElementById("data").textContent) };
(() => {
  const TYPES = {
    f8: Float64Array, f4: Float32Array, i8: BigInt64Array, u8: BigUint64Array,
    i4: Int32Array, u4: Uint32Array, u2: Uint16Array, i2: Int16Array, u1: Uint8Array, i1: Int8Array,
  };

  view.unpacked = ({ type, bytes }) => {
    const text = atob(bytes);
    const raw = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i += 1) raw[i] = text.charCodeAt(i);
    const values = new TYPES[type](raw.buffer);
    return type.endsWith("8") && type !== "f8" ? Float64Array.from(values, Number) : values;
  };

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

  /** The first place in an ascending array whose value is at least so large. */
  view.firstAtLeast = (values, wanted) => {
    let low = 0;
    let high = values.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (values[middle] < wanted) low = middle + 1;
      else high = middle;
    }
    return low;
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
})();
