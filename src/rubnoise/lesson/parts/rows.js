/* Junctions one after the other, in order of birth: drawn from a seed, or read from a run. */
const GAPS = 1;
const SIZES = 2;
const OFFSETS = 4;

/**
 * Junctions of a stationary contact. Births begin one longest life before the start, and who has died by then is left
 * out: those who are left are as many, as large and as old as a stationary contact has them.
 */
class Births {
  constructor(world) {
    this.world = world;
    this.contact = rub.model.contact(world);
    this.gaps = new rub.Random(world.seed, GAPS);
    this.sizes = new rub.Random(world.seed, SIZES);
    this.offsets = world.offset === 'uniform' ? new rub.Random(world.seed, OFFSETS) : null;
    this.longest = 2 * this.contact.sizes.high;
    this.count = 0;
    const { spacing } = this.contact;
    this.first =
      -this.longest + spacing * (world.births === 'regular' ? this.gaps.uniform() : this.gaps.exponential());
    this.next = this.first;
  }

  /** Append to rows every junction born up to a distance. */
  until(distance, rows) {
    while (this.next <= distance) {
      const diameter = this.contact.sizes.draw(this.sizes);
      const offset = this.offsets ? diameter * (2 * this.offsets.uniform() - 1) : 0;
      const row = this.junction(rows.length, diameter, offset);
      if (row.death > 0) rows.push(row);
      this.count += 1;
      this.next = this.following();
    }
  }

  /** Make junctions so many times stronger from now on. */
  strengthen(factor) {
    this.world.strength *= factor;
  }

  junction(id, diameter, offset) {
    const birth = this.next;
    const death = birth + 2 * rub.halfLife(diameter, offset);
    return { id, birth, diameter, offset, death, strength: this.world.strength };
  }

  /* Regular births are counted from the first: gaps added one by one would drift by their rounding. */
  following() {
    const { spacing } = this.contact;
    if (this.world.births === 'regular') return this.first + this.count * spacing;
    return this.next + spacing * this.gaps.exponential();
  }
}

/** Junctions of a run that has been made before: all there from the beginning; the row number is that of the run. */
class Replay {
  constructor(record, world) {
    const given = Object.entries(record).filter(([, each]) => each?.bytes);
    const columns = Object.fromEntries(given.map(([name, packed]) => [name, rub.unpacked(packed)]));
    const { birth, diameter, strength, death, offset } = columns;
    this.longest = 0;
    this.rows = Array.from(birth, (b, id) => {
      this.longest = Math.max(this.longest, 2 * diameter[id]);
      return {
        id,
        birth: b,
        diameter: diameter[id],
        offset: offset ? offset[id] : 0,
        death: death ? death[id] : b + 2 * rub.halfLife(diameter[id], offset ? offset[id] : 0),
        strength: strength ? strength[id] : world.strength,
      };
    });
    this.next = 0;
  }

  /** Make those stronger who have not been handed out. */
  strengthen(factor) {
    for (let i = this.next; i < this.rows.length; i += 1) this.rows[i].strength *= factor;
  }

  /** Append to rows every junction born up to a distance. */
  until(distance, rows) {
    while (this.next < this.rows.length && this.rows[this.next].birth <= distance) {
      rows.push(this.rows[this.next]);
      this.next += 1;
    }
  }
}

Object.assign(rub.model, { Births, Replay });
