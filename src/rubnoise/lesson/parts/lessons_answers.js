/* How a student may write a number: 0.33, 0,33, 1/3, 33 %, 3.3e-1, sqrt(20), e^-1, 2*pi, with or without its unit. */
const NUMBER = /^(\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?/i;
const CONSTANTS = { pi: Math.PI, e: Math.E };
const FUNCTIONS = { sqrt: Math.sqrt, exp: Math.exp, ln: Math.log };
const SIGNS = [/^[+-]/, /^[*/]/];
const OPERATIONS = { '+': (a, b) => a + b, '-': (a, b) => a - b, '*': (a, b) => a * b, '/': (a, b) => a / b };
const LOOKALIKES = [
  [/[\u2212\u2013\u2014]/g, '-'],
  [/[\u00d7\u00b7\u22c5]/g, '*'],
  [/[\u00f7:]/g, '/'],
  [/\*\*/g, '^'],
  [/\u00b2/g, '^2'],
  [/[\u00b5\u03bc]/g, 'u'],
  [/\u03c0/g, 'pi'],
  [/\u221a/g, 'sqrt'],
  [/[\u00a0\u2009\u202f]/g, ' '],
  [/\u00bd/g, '(1/2)'],
  [/\u2153/g, '(1/3)'],
  [/\u00bc/g, '(1/4)'],
];

/** What one of each unit that may be written is in the unit that was asked for. */
const UNITS = {
  '': { '%': 0.01 },
  um: { um: 1, micron: 1, microns: 1, nm: 1e-3, mm: 1e3, cm: 1e4, m: 1e6 },
  'um^2': { 'um^2': 1, um2: 1, 'mm^2': 1e6, mm2: 1e6 },
  'mm/s': { 'mm/s': 1, 'm/s': 1e3, 'cm/s': 10, 'um/s': 1e-3 },
  s: { s: 1, ms: 1e-3, us: 1e-6, min: 60 },
  Hz: { hz: 1, '1/s': 1, 's^-1': 1, khz: 1e3, 'rad/s': 1 / (2 * Math.PI) },
};

/** A text that is no number, with what to say about it. */
class Unread extends Error {}

/** Return a text as it may stand in HTML. */
const shown = (text) => text.trim().replace(/[&<>]/g, (letter) => `&#${letter.charCodeAt(0)};`);

/** One left-to-right pass over a text. */
class Reader {
  constructor(text) {
    this.rest = text;
  }

  /** Take what a pattern matches at the front, or nothing. */
  take(pattern) {
    this.rest = this.rest.trimStart();
    const found = pattern.exec(this.rest);
    if (!found) return null;
    this.rest = this.rest.slice(found[0].length);
    return found[0];
  }

  /** Read terms that are added, or at the level within these factors. */
  joined(level = 0) {
    if (level === SIGNS.length) return this.signed();
    let value = this.joined(level + 1);
    for (let sign = this.take(SIGNS[level]); sign; sign = this.take(SIGNS[level]))
      value = OPERATIONS[sign](value, this.joined(level + 1));
    return value;
  }

  signed() {
    const sign = this.take(/^[+-]/);
    if (sign) return sign === '-' ? -this.signed() : this.signed();
    const base = this.single();
    return this.take(/^\^/) ? base ** this.signed() : base;
  }

  single() {
    const digits = this.take(NUMBER);
    if (digits) return Number(digits);
    if (this.take(/^\(/)) return this.closed();
    const name = this.take(/^(sqrt|exp|ln|pi|e)(?![a-z])/i);
    if (!name) throw new Unread(`I cannot read “${shown(this.rest) || 'nothing'}” as a number.`);
    return this.named(name.toLowerCase());
  }

  named(name) {
    return name in CONSTANTS ? CONSTANTS[name] : FUNCTIONS[name](this.single());
  }

  closed() {
    const value = this.joined();
    if (!this.take(/^\)/)) throw new Unread('A bracket is not closed.');
    return value;
  }
}

/** Return a text with one spelling for each sign, and a point as its decimal mark. */
function plain(text) {
  const spelled = LOOKALIKES.reduce((sofar, [from, to]) => sofar.replace(from, to), text.trim());
  const grouped = spelled.replace(/(\d) (?=\d{3}(?!\d))/g, '$1');
  if (/\d,\d+[.,]\d|\d\.\d+,\d/.test(grouped)) {
    throw new Unread('Write one decimal mark and no marks between thousands.');
  }
  return grouped.replace(/(\d),(\d)/g, '$1.$2');
}

/** Return what one of a written unit is in the unit asked for. */
function scale(written, unit) {
  const known = UNITS[unit];
  const name = written.replace(/\s/g, '').toLowerCase();
  if (Object.hasOwn(known, name)) return known[name];
  if (unit === '') throw new Unread(`“${shown(written)}” is not expected here: the answer is a plain number.`);
  throw new Unread(
    `“${shown(written)}” is not a unit for this answer; answer in ${rub.lessons.words.unitName(unit)}.`,
  );
}

/**
 * Read a number.
 * @param {string} text what was typed
 * @param {string} unit the unit asked for, a key of UNITS
 * @returns {{value: number}|{problem: string}} the number in that unit, or why it is none
 */
function read(text, unit) {
  if (!text.trim()) return { problem: 'Type a number first.' };
  try {
    const reader = new Reader(plain(text));
    const number = reader.joined();
    const value = reader.rest.trim() ? number * scale(reader.rest, unit) : number;
    return Number.isFinite(value) ? { value } : { problem: 'That is not a finite number.' };
  } catch (problem) {
    if (problem instanceof Unread) return { problem: problem.message };
    throw problem;
  }
}

rub.answers = { read };
