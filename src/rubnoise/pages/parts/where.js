/* Conditions on junctions, with the grammar of `rubnoise junctions --where`:

     condition   = conjunction { "or" conjunction }
     conjunction = negation { "and" negation }
     negation    = "not" negation | "(" condition ")" | comparison
     comparison  = side { ("<" | "<=" | ">" | ">=" | "==" | "!=") side } | STATE
     side        = COLUMN | NUMBER [UNIT] | STATE                                  */
"use strict";
(() => {
  const NUMBER = "[+-]?[0-9]+(?:\\.[0-9]+)?(?:[eE][+-]?[0-9]{1,3})?(?![0-9.,_])";
  const UNIT = "(?!(?:and|or|not)\\b)[A-Za-z\\u00b5\\u03bc%][A-Za-z0-9\\u00b5\\u03bc%]*(?:(?:\\^|\\*\\*)-?[0-9]+)?(?![A-Za-z0-9_])";
  const WORD = new RegExp(
    `[ \\t\\r\\n]*(?:(?<number>(?<bare>${NUMBER})(?: *(?<unit>${UNIT}(?: ?[*/] ?${UNIT})*))?)` +
      "|(?<name>[A-Za-z_][A-Za-z0-9_]*)|(?<comparison><=|>=|==|!=|<(?!>)|>(?!<))|(?<bracket>[()])|(?<end>$))",
    "iy",
  );
  const COMPARISONS = {
    "<": (a, b) => a < b, "<=": (a, b) => a <= b, ">": (a, b) => a > b,
    ">=": (a, b) => a >= b, "==": (a, b) => a === b, "!=": (a, b) => a !== b,
  };
  const LONGEST = 1000;
  const DEEPEST = 200;

  class ConditionRefused extends Error {}
  view.ConditionRefused = ConditionRefused;

  function* words(text) {
    if (text.length > LONGEST) throw new ConditionRefused(`a condition of more than ${LONGEST} characters`);
    for (let place = 0; ;) {
      WORD.lastIndex = place;
      const found = WORD.exec(text);
      if (found === null) {
        const rest = text.slice(place).trimStart();
        throw new ConditionRefused(`"${rest.slice(0, 12)}" is no part of a condition`);
      }
      const { number, bare, unit, name, comparison, bracket } = found.groups;
      if (number !== undefined) yield { sort: "number", text: number, bare, unit };
      else if (name !== undefined) yield { sort: ["and", "or", "not"].includes(name) ? name : "name", text: name };
      else if (comparison !== undefined) yield { sort: "comparison", text: comparison };
      else if (bracket !== undefined) yield { sort: bracket, text: bracket };
      else {
        yield { sort: "end", text: "the end" };
        return;
      }
      place = WORD.lastIndex;
    }
  }

  class Reader {
    constructor(text, rows, states) {
      Object.assign(this, { words: words(text), rows, states: { complete: 0, ...states }, depth: 0 });
      this.next = this.words.next().value;
    }

    whole() {
      if (this.next.sort === "end") throw new ConditionRefused("no condition; for instance: diameter > 6 um");
      const chosen = this.condition();
      if (this.next.sort === ")") throw new ConditionRefused("no parenthesis is open here");
      if (this.next.sort !== "end") throw this.misplaced();
      return chosen;
    }

    condition() {
      const parts = [this.conjunction()];
      while (this.next.sort === "or") {
        this.take();
        parts.push(this.conjunction());
      }
      return parts.length === 1 ? parts[0] : (i) => parts.some((part) => part(i));
    }

    conjunction() {
      const parts = [this.negation()];
      while (this.next.sort === "and") {
        this.take();
        parts.push(this.negation());
      }
      return parts.length === 1 ? parts[0] : (i) => parts.every((part) => part(i));
    }

    negation() {
      if (this.next.sort !== "not" && this.next.sort !== "(") return this.comparison();
      const opening = this.take();
      this.depth += 1;
      if (this.depth > DEEPEST) throw new ConditionRefused(`more than ${DEEPEST} levels of parentheses and not`);
      let chosen;
      if (opening.sort === "not") {
        const part = this.negation();
        chosen = (i) => !part(i);
      } else {
        chosen = this.condition();
        if (this.next.sort === "end") throw new ConditionRefused("a parenthesis is not closed");
        if (this.next.sort !== ")") throw this.misplaced();
        this.take();
      }
      this.depth -= 1;
      return chosen;
    }

    comparison() {
      let left = this.side();
      if (this.next.sort !== "comparison") return this.alone(left);
      const parts = [];
      while (this.next.sort === "comparison") {
        const operator = this.take().text;
        const right = this.side();
        parts.push(this.compared(left, operator, right));
        left = right;
      }
      return parts.length === 1 ? parts[0] : (i) => parts.every((part) => part(i));
    }

    side() {
      const word = this.take();
      if (word.sort === "number") return word;
      if (word.sort !== "name") throw new ConditionRefused(`"${word.text}" stands where a column or a number is needed`);
      if (!(word.text in this.rows.units) && !(word.text in this.states)) {
        const known = [...Object.keys(this.rows.units), ...Object.keys(this.states)].join(", ");
        throw new ConditionRefused(`no column ${word.text}; one of ${known}`);
      }
      return word;
    }

    alone(word) {
      if (word.sort === "number") throw new ConditionRefused("a number by itself; for instance: diameter > 6 um");
      if (!(word.text in this.states)) {
        throw new ConditionRefused(`${word.text} is compared with nothing; for instance: ${word.text} > 0`);
      }
      return this.inState(this.states[word.text]);
    }

    inState(bit) {
      const state = this.rows.state;
      return bit ? (i) => (state[i] & bit) !== 0 : (i) => state[i] === 0;
    }

    compared(left, operator, right) {
      if ([left, right].some((side) => side.sort === "name" && side.text in this.states)) return this.state(left, operator, right);
      const names = [left, right].filter((side) => side.sort === "name").map((side) => side.text);
      if (names.length === 0) throw new ConditionRefused("neither side is a column");
      const [units, others] = [this.rows.units[names[0]], this.rows.units[names[names.length - 1]]];
      if (units !== others) throw new ConditionRefused(`${names[0]} is in ${units}, ${names[1]} in ${others}`);
      const compare = COMPARISONS[operator];
      const value = (side) => {
        if (side.sort === "name") {
          const column = this.rows[side.text];
          return (i) => column[i];
        }
        const number = this.quantity(side, names[0], units);
        return () => number;
      };
      const [a, b] = [value(left), value(right)];
      return (i) => compare(a(i), b(i));
    }

    state(left, operator, right) {
      const [word, other] = left.sort === "name" && left.text in this.states ? [left, right] : [right, left];
      if (other.text !== "state") throw new ConditionRefused(`${word.text} is a state; write ${word.text}, or not ${word.text}`);
      if (operator !== "==" && operator !== "!=") throw new ConditionRefused(`states have no order; write state == ${word.text}`);
      const chosen = this.inState(this.states[word.text]);
      return operator === "==" ? chosen : (i) => !chosen(i);
    }

    /** A number with a unit is shifted by a power of ten in its text, so that it is rounded once. */
    quantity({ text, bare, unit }, name, units) {
      let number = bare;
      if (unit !== undefined) {
        const powers = view.data.units[units];
        if (powers === undefined) throw new ConditionRefused(`${name} has no unit; write ${bare}`);
        if (!Object.hasOwn(powers, unit)) {
          throw new ConditionRefused(`"${unit}" is not among the units of ${name} here: ${Object.keys(powers).join(", ")}`);
        }
        const [digits, power = "0"] = bare.toLowerCase().split("e");
        number = `${digits}e${Number(power) + powers[unit]}`;
      }
      const value = Number(number);
      if (!Number.isFinite(value)) throw new ConditionRefused(`${text} is too large a number`);
      return value;
    }

    take() {
      const word = this.next;
      if (word.sort !== "end") this.next = this.words.next().value;
      return word;
    }

    misplaced() {
      return new ConditionRefused(`"${this.next.text}" does not belong here; conditions are joined by and, or`);
    }
  }

  /** Which rows a condition chooses; throws ConditionRefused where the text is none. */
  view.where = (text, rows, states) => new Reader(text, rows, states).whole();
})();
