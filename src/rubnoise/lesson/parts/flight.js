/* A slider that is free to leave its contact. In units of c, s0 and 1/omega_c it obeys z'' = P - 1: each summit (place
 * s_i, height h_i) with an overlap o = h_i - (s - s_i)^2 - z > 0 bears o max(0, 1 + LOSS o')/N of the weight. The
 * law is that of `load.motion = "free"` with `impact_damping`; the page goes on in steps of STEP or finer.
 */
const { Numbers } = rub;
const LOSS = 0.3; // impact_damping times s0 omega_c
const STEP = 0.01; // over 1 + v, of 1/omega_c
const STRIDE = 8; // steps from one record to the next
const SETTLED = 20; // of 1/omega_c: what is before is left out of the means
const SIDE = 13; // of c: beyond, no summit is drawn, and none is high enough to be touched
const SUMMITS = 4; // the stream of random numbers
const FASTEST = 5;
const MOST = 5; // junctions
const COLUMNS = ['place', 'z', 'load', 'touching', 'sumTime', 'sumApart', 'sumLoad', 'sumRise'];

/** Return the scales of a world: c and s0 in um, omega_c in 1/s, and v = V/(c omega_c). */
function scalesOf(world) {
  const length = (2 * rub.model.contact(world).diameter) / Math.sqrt(Math.PI);
  const { resonance: rate, scale: height } = rub.load.of(world);
  return { length, height, rate, speed: world.speed / (length * rate) };
}

/** Return why a slider cannot hop on the page, or an empty text. */
function problemOf(world) {
  const { speed } = scalesOf(world);
  const good = speed <= FASTEST && world.meanCount <= MOST;
  return good ? '' : `a slider that hops: at most ${MOST} junctions, and a speed of at most ${FASTEST} c ω_c`;
}

/** Summits in order of place: random in place and, above the lowest that are ever touched, of exponential heights. */
class Summits {
  constructor(live, speed, seed) {
    this.random = new rub.Random(seed, SUMMITS);
    this.bottom = -(4 + 2 * Math.log1p(speed));
    this.gap = (Math.sqrt(Math.PI) * Math.exp(this.bottom)) / live;
    Object.assign(this, { place: new Numbers(), height: new Numbers(), next: -SIDE });
  }

  until(place) {
    for (; this.next <= place; this.next += this.gap * this.random.exponential()) {
      this.place.push(this.next);
      this.height.push(this.bottom + this.random.exponential());
    }
  }

  /** Return the numbers of the first summit from a place on, and of the first beyond another. */
  between(from, to) {
    this.until(to);
    return [this.place.find(from) + 1, this.place.find(to) + 1];
  }
}

/** The motion from z = z' = 0 on, with columns every few steps; z in s0, place in c, time in 1/omega_c. */
class Flight {
  constructor(world, summits) {
    Object.assign(this, scalesOf(world), { live: world.meanCount });
    this.summits = summits ?? new Summits(this.live, this.speed, world.seed);
    this.step = STEP / (1 + this.speed);
    Object.assign(this, { time: 0, z: 0, rise: 0, load: 0, touching: 0 });
    this.sums = { time: 0, apart: 0, load: 0, rise: 0 };
    this.columns = Object.fromEntries(COLUMNS.map((name) => [name, new Numbers()]));
    /* Where contact is lost (touching 0) and made again, in c. */
    this.landmarks = { place: new Numbers(), touching: new Numbers() };
    [this.near, this.tops] = [[], []];
    this.record();
  }

  /** Note the summits that may be touched before the next record: the slider falls no faster than freely. */
  look() {
    const place = this.speed * this.time;
    const span = STRIDE * this.step;
    const low = this.z - Math.abs(this.rise) * span - span * span;
    const [first, last] = this.summits.between(place - SIDE / 2, place + SIDE / 2);
    this.near.length = this.tops.length = 0;
    for (let i = first; i < last; i += 1) {
      const off = Math.max(0, Math.abs(this.summits.place.values[i] - place) - this.speed * span);
      if (this.summits.height.values[i] - off * off <= low) continue;
      this.near.push(this.summits.place.values[i]);
      this.tops.push(this.summits.height.values[i]);
    }
  }

  /** Return what is borne over the weight, and set how many summits are touched. */
  borne(time, z, rise) {
    let sum = 0;
    this.touching = 0;
    for (let i = 0; i < this.near.length; i += 1) {
      const off = this.speed * time - this.near[i];
      const overlap = this.tops[i] - off * off - z;
      if (overlap <= 0) continue;
      this.touching += 1;
      sum += overlap * Math.max(0, 1 - LOSS * (2 * off * this.speed + rise));
    }
    return sum / this.live;
  }

  /** Compute as far as a distance in um. */
  until(distance) {
    while (this.speed * this.time * this.length < distance) {
      this.look();
      for (let n = 0; n < STRIDE; n += 1) this.move();
      this.record();
    }
  }

  /* The middle of a step: of second order, also where a summit is touched or left. */
  move() {
    const { step, sums } = this;
    const before = this.touching;
    this.load = this.borne(this.time, this.z, this.rise);
    const { touching } = this;
    if (before > 0 !== touching > 0) this.mark(touching);
    const half = this.rise + 0.5 * step * (this.load - 1);
    const pull = this.borne(this.time + 0.5 * step, this.z + 0.5 * step * this.rise, half) - 1;
    if (this.time >= SETTLED) {
      sums.time += step;
      if (touching === 0) sums.apart += step;
      sums.load += step * (pull + 1);
      sums.rise += step * half * half;
    }
    this.z += step * half;
    this.rise += step * pull;
    this.time += step;
    this.touching = touching;
  }

  mark(touching) {
    this.landmarks.place.push(this.speed * this.time);
    this.landmarks.touching.push(touching);
  }

  record() {
    const { columns, sums } = this;
    const { time, apart, load, rise } = sums;
    const now = { place: this.speed * this.time, z: this.z, load: this.load, touching: this.touching };
    const all = { ...now, sumTime: time, sumApart: apart, sumLoad: load, sumRise: rise };
    for (const [name, value] of Object.entries(all)) columns[name].push(value);
  }

  /** Return the number of the record at a distance in um. */
  at(distance) {
    return Math.max(0, this.columns.place.find(distance / this.length));
  }

  /** Return whether a summit is touched at a distance in um. */
  touchesAt(distance) {
    const { place, touching } = this.landmarks;
    const i = place.find(distance / this.length);
    return i >= 0 ? touching.values[i] > 0 : this.columns.touching.values[1] > 0;
  }

  /** Return the separation in s0 at a distance, between two records along a line. */
  heightAt(distance) {
    const { place, z } = this.columns;
    return rub.between(z.values, place.placeOf(distance / this.length));
  }

  /** Return the next place in um at which contact is lost or made, no further than an end; or null. */
  next(distance, end) {
    const { place, touching } = this.landmarks;
    const i = place.find(distance / this.length) + 1;
    for (let to = distance; i >= place.length && to < end; to += this.length) this.until(to + this.length);
    if (i >= place.length || place.values[i] * this.length > end) return null;
    const kind = touching.values[i] ? 'contact made' : 'contact lost';
    /* The place itself, and not a rounding before it: else the same event would come again. */
    return { kind, distance: place.values[i] * this.length * (1 + 1e-12) };
  }

  /** Return means over time so far: share of time apart, load over weight, and the rms of z' in um/s. */
  moments(distance) {
    const i = this.at(distance);
    const mean = (name) => this.columns[name].values[i] / this.columns.sumTime.values[i];
    const riseStd = Math.sqrt(mean('sumRise')) * this.height * this.rate;
    return { apartShare: mean('sumApart'), loadMean: mean('sumLoad'), riseStd, relativeSpeed: this.speed };
  }
}

rub.flight = { Flight, scalesOf, problemOf, SIDE };
