/* The contact at every tick, computed as far as somebody has looked: area, count, force, slider, and sums of them. */
const COLUMNS = ['area', 'count', 'shear', 'force', 'impulse', 'displacement', 'velocity', 'separation', 'rise'];
const SQUARED = ['area', 'count', 'force', 'displacement', 'separation'];
const SUMS = [...SQUARED, ...SQUARED.map((name) => `${name}Square`), 'velocitySquare'];
const TOGETHER = 256;

/** Ticks i * tick for i = 0 ... last; ready of them are filled in, and sums[...][i] runs over ticks 0 ... i. */
class Trace {
  constructor(world, source, tick, last, start) {
    Object.assign(this, { world, source, tick, last, start, rows: [], ready: 0, oldest: 0, sums: {} });
    this.pulse = rub.model.pulseOf(world);
    this.reserve(4096);
  }

  /* Columns grow by doubling: a knob that is turned makes a run with every move. */
  reserve(count) {
    this.room = Math.min(count, this.last + 1);
    const grown = (old) => {
      const column = new Float64Array(this.room);
      if (old) column.set(old.subarray(0, Math.min(old.length, this.room)));
      return column;
    };
    COLUMNS.forEach((name) => {
      this[name] = grown(this[name]);
    });
    SUMS.forEach((name) => {
      this.sums[name] = grown(this.sums[name]);
    });
  }

  /** Fill in ticks up to one that is wanted, and draw junctions as far. */
  until(wanted) {
    const target = Math.min(wanted, this.last);
    while (this.ready <= target) this.append(Math.min(this.ready + TOGETHER, this.last + 1));
  }

  append(end) {
    while (end > this.room) this.reserve(2 * this.room);
    this.source.until((end - 1) * this.tick, this.rows);
    this.lives(this.ready, end);
    const from = this.ready;
    this.ready = end;
    this.slide(from);
    this.sumUp(from);
  }

  /** Add up the lives that meet ticks from one up to, not including, another. */
  lives(from, end) {
    const { rows, tick } = this;
    while (this.oldest < rows.length && rows[this.oldest].death <= (from - 1) * tick) this.oldest += 1;
    for (let j = this.oldest; j < rows.length; j += 1) {
      this.add(rows[j], Math.max(from, Math.ceil(rows[j].birth / tick)), end);
    }
  }

  /**
   * Add one life: area, count and shear (the force at constant gap) at ticks, and in impulse the integral of shear up
   * to each, in uN um.
   */
  add(row, first, end) {
    const { pulse, tick } = this;
    const life = row.death - row.birth;
    let reached = Math.max(0, Math.min((first - 1) * tick - row.birth, life));
    let before = pulse.sum ? pulse.sum(reached, row.diameter) : 0;
    for (let i = first; i < end && (i - 1) * tick < row.death; i += 1) {
      const age = i * tick - row.birth;
      const next = Math.min(age, life);
      const sum = pulse.sum
        ? pulse.sum(next, row.diameter)
        : before + pulse.between(reached, next, row.diameter, row.offset);
      this.impulse[i] += (sum - before) * row.strength;
      [before, reached] = [sum, next];
      if (i * tick >= row.death) return;
      const area = pulse.area(age, row.diameter, row.offset);
      this.area[i] += area;
      this.count[i] += 1;
      this.shear[i] += area * row.strength;
    }
  }

  /** Move the slider on from a tick; under a load that weighs it rises, too, and the force is what it bears. */
  slide(from) {
    const { world, tick } = this;
    const time = tick / world.speed;
    const constants = rub.slider.propagator(world, time);
    const state = from ? [this.displacement[from - 1], this.velocity[from - 1]] : [this.start, 0];
    const borne = this.bearing(from, time);
    for (let i = from; i < this.ready; i += 1) {
      const mean = borne(i);
      if (i) rub.slider.step(constants, state, this.force[i - 1], this.force[i], mean);
      this.displacement[i] = state[0];
      this.velocity[i] = state[1];
    }
  }

  /** Return a function that fills in the force at a tick and returns its mean over the way there, in uN. */
  bearing(from, time) {
    const { world, tick, shear, impulse } = this;
    if (world.support !== 'load') {
      return (i) => {
        this.force[i] = shear[i];
        return impulse[i] / tick;
      };
    }
    const mean = world.strength * world.meanArea;
    const begin = [rub.load.of(world).scale * (shear[0] / mean - 1), 0]; // as it is borne at the start
    const state = from ? [this.separation[from - 1], this.rise[from - 1]] : begin;
    const follow = rub.load.follower(world, mean, time, state);
    return (i) => {
      const [here, over] = i ? follow(shear[i - 1], shear[i], impulse[i] / tick) : [1, 1];
      [this.separation[i], this.rise[i]] = state;
      this.force[i] = mean * here;
      return mean * over;
    };
  }

  /** Return a column at a distance in um, by a straight line between ticks. */
  at(name, distance) {
    return rub.between(this[name], distance / this.tick);
  }

  /* A junction that is not born yet gets the new strength too. */
  strengthen(factor) {
    if (factor === 1) return;
    this.source.strengthen(factor);
    for (const row of this.rows) row.strength *= factor;
    for (let i = 0; i < this.ready; i += 1) {
      this.shear[i] *= factor;
      this.impulse[i] *= factor;
    }
  }

  sumUp(from) {
    for (let i = from; i < this.ready; i += 1) {
      for (const name of SQUARED) {
        this.total(name, i, this[name][i]);
        this.total(`${name}Square`, i, this[name][i] ** 2);
      }
      this.total('velocitySquare', i, this.velocity[i] ** 2);
    }
  }

  total(name, i, value) {
    this.sums[name][i] = value + (i ? this.sums[name][i - 1] : 0);
  }

  /** Give the same contact another slider, and its junctions the strength of the settings. */
  reslide(world, start) {
    this.strengthen(world.strength / this.world.strength);
    this.world = world;
    this.start = start;
    this.slide(0);
    this.sumUp(0);
  }
}

rub.Trace = Trace;
