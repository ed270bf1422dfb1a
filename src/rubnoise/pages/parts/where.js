/* Conditions on junctions, with the grammar of `rubnoise junctions --where`:

     condition   = conjunction { "or" conjunction }
     conjunction = negation { "and" negation }
     negation    = "not" negation | "(" condition ")" | comparison
     comparison  = side { ("<" | "<=" | ">" | ">=" | "==" | "!=") side } | STATE
     side        = COLUMN | NUMBER [UNIT] | STATE                                  */
const NUMBER = "[+-]?[0-9]+(?:\\.[0-9]+)?(?:[eE][+-]?[0-9]{1,3})?(?![0-9.,_])";
const UNIT = "(?!(?:and|or|not)\\b)[A-Za-z\\u00b5\\u03bc%][A-Za-z0-9\\u00b5\\u03bc%]*(?:(?:\\^|\\*\\*)-?[0-9]+)?(?![A-Za-z0-9_])";
const WORD = new RegExp(
  `[ \\t\\r\\n]*(?:(?<number>${NUMBER})(?: *(?<unit>${UNIT}(?: ?[*/] ?${UNIT})*))?` +
    "|(?<name>[A-Za-z_][A-Za-z0-9_]*)|<=|>=|==|!=|<(?!>)|>(?!<)|[()])",
  "iy",
);
const COMPARISONS = {
  "<": (a, b) => a < b, "<=": (a, b) => a <= b, ">": (a, b) => a > b,
  ">=": (a, b) => a >= b, "==": (a, b) => a === b, "!=": (a, b) => a !== b,
};
const JOINS = [["or", "some"], ["and", "every"]];
const RESERVED = ["and", "or", "not"];
const LONGEST = 1000;
const DEEPEST = 200;

class ConditionRefused extends Error {}
view.ConditionRefused = ConditionRefused;

const refuse = (why) => {
  throw new ConditionRefused(why);
};

const wordsOf = (text) => {
  if (text.length > LONGEST) refuse(`a condition of more than ${LONGEST} characters`);
  const found = [];
  for (let place = 0; place < text.length; place = WORD.lastIndex) {
    WORD.lastIndex = place;
    const word = WORD.exec(text);
    if (word === null) refuse(`"${text.slice(place).trimStart().slice(0, 12)}" is no part of a condition`);
    found.push({ text: word[0].trim(), ...word.groups });
  }
  return [...found, { text: "the end" }];
};

class Reader {
  constructor(text, rows, states) {
    Object.assign(this, { words: wordsOf(text.trim()), place: 0, depth: 0, rows, states: { complete: 0, ...states } });
  }

  get next() {
    return this.words[this.place];
  }

  get isOver() {
    return this.place === this.words.length - 1;
  }

  /** Take the next word if it is one of these; null if not. */
  take(...texts) {
    const { text } = this.next;
    if (this.isOver || !texts.includes(text)) return null;
    this.place += 1;
    return text;
  }

  whole() {
    if (this.isOver) refuse("no condition; for instance: diameter > 6 um");
    const chosen = this.joined(0);
    if (this.next.text === ")") refuse("no parenthesis is open here");
    return this.isOver ? chosen : this.misplaced();
  }

  joined(level) {
    if (level === JOINS.length) return this.negation();
    const [word, method] = JOINS[level];
    const parts = [this.joined(level + 1)];
    while (this.take(word)) parts.push(this.joined(level + 1));
    return parts.length === 1 ? parts[0] : (i) => parts[method]((part) => part(i));
  }

  negation() {
    const opening = this.take("not", "(");
    if (!opening) return this.comparison();
    this.depth += 1;
    if (this.depth > DEEPEST) refuse(`more than ${DEEPEST} levels of parentheses and not`);
    const part = opening === "not" ? this.negation() : this.joined(0);
    this.depth -= 1;
    if (opening === "not") return (i) => !part(i);
    if (this.isOver) refuse("a parenthesis is not closed");
    return this.take(")") ? part : this.misplaced();
  }

  comparison() {
    const operators = Object.keys(COMPARISONS);
    const parts = [];
    let left = this.side();
    for (let operator = this.take(...operators); operator; operator = this.take(...operators)) {
      const right = this.side();
      parts.push(this.compared(left, operator, right));
      left = right;
    }
    return parts.length ? (i) => parts.every((part) => part(i)) : this.alone(left);
  }

  side() {
    const word = this.next;
    const { text, number, name } = word;
    if (!number && (!name || RESERVED.includes(name))) refuse(`"${text}" stands where a column or a number is needed`);
    if (name && !(name in this.rows.units) && !(name in this.states)) {
      refuse(`no column ${name}; one of ${[...Object.keys(this.rows.units), ...Object.keys(this.states)].join(", ")}`);
    }
    this.place += 1;
    return word;
  }

  alone({ number, name }) {
    if (number) refuse("a number by itself; for instance: diameter > 6 um");
    if (!(name in this.states)) refuse(`${name} is compared with nothing; for instance: ${name} > 0`);
    return this.inState(this.states[name]);
  }

  inState(bit) {
    const state = this.rows.state;
    return bit ? (i) => (state[i] & bit) !== 0 : (i) => state[i] === 0;
  }

  compared(left, operator, right) {
    const names = [left, right].map((side) => side.name).filter(Boolean);
    const state = names.find((name) => name in this.states);
    if (state) return this.state(state, names, operator);
    if (!names.length) refuse("neither side is a column");
    const [units, others] = [this.rows.units[names[0]], this.rows.units[names.at(-1)]];
    if (units !== others) refuse(`${names[0]} is in ${units}, ${names[1]} in ${others}`);
    const compare = COMPARISONS[operator];
    const [a, b] = [left, right].map((side) => {
      if (side.name) return (i) => this.rows[side.name][i];
      const number = this.quantity(side, names[0], units);
      return () => number;
    });
    return (i) => compare(a(i), b(i));
  }

  state(state, names, operator) {
    if (!names.includes("state")) refuse(`${state} is a state; write ${state}, or not ${state}`);
    if (operator !== "==" && operator !== "!=") refuse(`states have no order; write state == ${state}`);
    const chosen = this.inState(this.states[state]);
    return operator === "==" ? chosen : (i) => !chosen(i);
  }

  /** A number with a unit is shifted by a power of ten in its text, so that it is rounded once. */
  quantity({ text, number, unit }, name, units) {
    let shifted = number;
    if (unit !== undefined) {
      const powers = view.data.units[units] ?? refuse(`${name} has no unit; write ${number}`);
      if (!Object.hasOwn(powers, unit)) {
        refuse(`"${unit}" is not among the units of ${name} here: ${Object.keys(powers).join(", ")}`);
      }
      const [digits, power = "0"] = number.toLowerCase().split("e");
      shifted = `${digits}e${Number(power) + powers[unit]}`;
    }
    const value = Number(shifted);
    return Number.isFinite(value) ? value : refuse(`${text} is too large a number`);
  }

  misplaced() {
    return refuse(`"${this.next.text}" does not belong here; conditions are joined by and, or`);
  }
}

/** Which rows a condition chooses; throws ConditionRefused where the text is none. */
view.where = (text, rows, states) => new Reader(text, rows, states).whole();
