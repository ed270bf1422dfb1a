/* What the contact can bear, G(s) = sum of psi_i A_i(s), at every place that a slider may come to, forward or back. */
const CELLS_PER_LIFE = 200;
const CELLS_AT_ONCE = 64;
const PAST = 3;

/** Junctions that had died before the start, drawn as far back as the slider runs. */
class Past {
  constructor(world, contact, alive, at = {}) {
    Object.assign(this, { world, contact, rows: [] });
    this.random = new rub.Random(world.seed, PAST);
    this.taken = alive.filter((row) => row.birth <= 0).map((row) => row.birth);
    this.regular = world.births === 'regular';
    this.next = at.first ?? alive[0]?.birth ?? 0;
    if (this.regular) while (this.next <= 0) this.next += contact.spacing;
    else this.next = 0;
    this.step();
  }

  step() {
    this.next -= this.contact.spacing * (this.regular ? 1 : this.random.exponential());
  }

  /** Draw back to all who were born behind a place; those alive at the start are known, and left out here. */
  until(place) {
    while (this.next >= place) {
      const known = this.regular && this.taken.some((birth) => Math.abs(birth - this.next) < 1e-6);
      const diameter = known ? Infinity : this.diameter();
      if (this.next + 2 * diameter <= 0) this.add(diameter);
      this.step();
    }
  }

  /* At random, who outlives the start is none of the past; in a row, everybody who is not alive there has died. */
  diameter() {
    for (let tries = 0; tries < 1000; tries += 1) {
      const diameter = this.contact.sizes.draw(this.random);
      if (!this.regular || this.next + 2 * diameter <= 0) return diameter;
    }
    return Infinity;
  }

  add(diameter) {
    const death = this.next + 2 * diameter;
    this.rows.push({ birth: this.next, diameter, death, strength: this.world.strength });
  }
}

/** A list of doubles that grows by doubling. */
class Numbers {
  constructor() {
    this.values = new Float64Array(1024);
    this.length = 0;
  }

  push(value) {
    if (this.length === this.values.length) {
      const grown = new Float64Array(2 * this.length);
      grown.set(this.values);
      this.values = grown;
    }
    this.values[this.length++] = value;
  }

  get last() {
    return this.values[this.length - 1];
  }

  /** Return the number of the last value that is not above another; values never fall. */
  find(value) {
    return rub.firstPlace(this.length, (i) => this.values[i] > value) - 1;
  }

  /** Return the place of a value among values that never fall: the number of the one before it, and a part. */
  placeOf(value) {
    const i = Math.max(0, Math.min(this.find(value), this.length - 2));
    const step = this.values[i + 1] - this.values[i];
    return i + (step > 0 ? Math.max(0, Math.min(1, (value - this.values[i]) / step)) : 0);
  }
}

/** One side of the field: nodes outward from s = 0, each with its force once the node behind it is known. */
class Side {
  constructor() {
    Object.assign(this, { place: new Numbers(), force: new Numbers(), last: null });
  }

  /** Add a node: its force, and the integral of the force up to it from where that of the last node counts. */
  put(place, force, sum) {
    const { last } = this;
    this.last = { place, force, sum, width: 0, miss: 0 };
    if (!last) return;
    const width = Math.abs(place - last.place);
    const miss = Math.abs(sum - last.sum) / width - 0.5 * (force + last.force);
    Object.assign(this.last, { width, miss });
    const shift = (last.width * last.miss + width * miss) / (last.width + width);
    this.place.push(last.place);
    this.force.push(Math.max(0, last.force + shift));
  }
}

/**
 * The field as a broken line: nodes lie a 200th of a life apart, and at every birth, mid-life and death besides, so
 * that corners of G are nodes. Each is moved by what the line misses of the integral of G in the cells on its two
 * sides: the work that a slip takes is then that of G. A triangle is exact.
 */
class Field {
  /** source hands out junctions, rows are those that it has handed out, and end is where the last node lies. */
  constructor(world, source, rows, end, cellsPerLife = CELLS_PER_LIFE) {
    Object.assign(this, { source, rows, end, oldest: 0, work: 0 });
    const contact = rub.model.contact(world);
    this.pulse = contact.pulse;
    this.width = contact.meanLife / cellsPerLife;
    this.longest = 2 * contact.sizes.high;
    source.until(0, rows);
    this.past = new Past(world, contact, rows, source);
    this.ahead = new Side();
    this.behind = new Side();
    this.put(this.ahead, 0, this.alive(rows, 0, 0));
  }

  /** Return the place of a node, in um; node 0 lies at s = 0. */
  place(node) {
    return this.column('place', node);
  }

  /** Return what the contact can bear at a node, in uN. */
  force(node) {
    return this.column('force', node);
  }

  column(name, node) {
    if (node >= 0) {
      while (node >= this.ahead.force.length) this.forward();
      return this.ahead[name].values[node];
    }
    while (-node >= this.behind.force.length) this.backward();
    return this.behind[name].values[-node];
  }

  forward() {
    const from = this.ahead.last.place;
    const to = Math.min(from + CELLS_AT_ONCE * this.width, this.end + CELLS_AT_ONCE * this.width);
    this.source.until(to, this.rows);
    while (this.oldest < this.rows.length && this.rows[this.oldest].death <= from) this.oldest += 1;
    const alive = this.alive(this.rows, from, to, this.oldest);
    this.ahead.last.sum = this.sum(alive, from);
    for (const place of this.nodes(alive, from, to)) if (place > from) this.put(this.ahead, place, alive);
  }

  backward() {
    if (!this.behind.last) this.put(this.behind, 0, this.alive(this.rows, 0, 0));
    const to = this.behind.last.place;
    const from = to - CELLS_AT_ONCE * this.width;
    this.past.until(from - this.longest);
    const alive = [...this.alive(this.rows, from, to), ...this.alive(this.past.rows, from, to)];
    this.behind.last.sum = this.sum(alive, to);
    for (const place of this.nodes(alive, from, to).reverse()) if (place < to) this.put(this.behind, place, alive);
  }

  alive(rows, from, to, first = 0) {
    const found = [];
    for (let i = first; i < rows.length; i += 1) {
      if (rows === this.rows && rows[i].birth > to) break;
      if (rows[i].birth <= to && rows[i].death >= from) found.push(rows[i]);
    }
    return found;
  }

  /* The end of the run is a node: there the slider is stopped. */
  nodes(alive, from, to) {
    const wanted = Array.from({ length: CELLS_AT_ONCE + 1 }, (_, i) => from + (i * (to - from)) / CELLS_AT_ONCE);
    wanted.push(this.end);
    for (const row of alive) wanted.push(row.birth, row.birth + row.diameter, row.death);
    const inside = wanted.filter((place) => place >= from && place <= to);
    inside.sort((a, b) => a - b);
    return inside.filter((place, i) => i === 0 || place - inside[i - 1] > 1e-9 * this.width);
  }

  put(side, place, alive) {
    let force = 0;
    for (const row of alive) {
      if (place < row.death) force += row.strength * this.pulse.area(place - row.birth, row.diameter);
    }
    side.put(place, force, this.sum(alive, place));
    this.work += 0.2 + 0.1 * alive.length;
  }

  /** Return the integral of the force of some junctions from their births up to a place, in uN um. */
  sum(alive, place) {
    let total = 0;
    for (const { birth, death, diameter, strength } of alive) {
      if (place > birth) total += strength * this.pulse.sum(Math.min(place, death) - birth, diameter);
    }
    return total;
  }
}

Object.assign(rub, { Field, Numbers });
