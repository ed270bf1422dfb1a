/* What a run has shown so far, from its rows alone: looks at evenly spaced places, and meetings at births. */
const { lessons } = rub;
const LOOKS_A_LIFE = 40; // fine enough that nothing but a life's soft ends happens between two looks
const MOST_LIVES = 400; // of a run that is measured whole

/** Sums of the first powers of values about a place near their mean, which keeps digits. */
class Sums {
  constructor(about) {
    this.about = about;
    this.powers = [0, 0, 0, 0];
  }

  add(value) {
    const left = value - this.about;
    for (let n = 0, power = 1; n < 4; n += 1, power *= left) this.powers[n] += power;
  }

  get count() {
    return this.powers[0];
  }

  get shift() {
    return this.powers[1] / this.count;
  }

  get mean() {
    return this.about + this.shift;
  }

  get variance() {
    return this.powers[2] / this.count - this.shift ** 2;
  }

  get skewness() {
    const third = this.powers[3] / this.count - 3 * this.shift * this.variance - this.shift ** 3;
    return third / this.variance ** 1.5;
  }
}

/** Follows a run from distance 0: junctions as they are born and die, and looks at the contact on the way. */
class Watch {
  constructor(exact, pulse) {
    Object.assign(this, { pulse, spacing: exact.spacing, life: exact.lifeMean, step: exact.lifeMean / LOOKS_A_LIFE });
    Object.assign(this, {
      area: new Sums(exact.areaMean),
      counts: new Sums(exact.countMean),
      window: new Sums(exact.countMean),
    });
    for (const name of ['gaps', 'born', 'lives', 'met', 'alive', 'ages', 'beyond', 'short']) this[name] = new Sums(0);
    this.live = [];
    this.next = 0;
    this.looks = 0;
    this.before = NaN;
    this.inWindow = 0;
    this.windowEnd = this.life;
  }

  /** Take notice of everything up to a distance, rows being in order of birth. */
  follow(rows, distance) {
    for (let place = this.looks * this.step; place <= distance; place = this.looks * this.step) {
      while (this.next < rows.length && rows[this.next].birth <= place) this.meet(rows[this.next]);
      this.look(place);
      this.looks += 1;
    }
  }

  meet(row) {
    this.next += 1;
    if (row.birth > 0) this.birth(row);
    this.live.push(row);
  }

  birth(row) {
    this.met.add(this.leave(row.birth));
    this.born.add(row.diameter);
    this.lives.add(row.death - row.birth);
    this.endWindows(row.birth);
    this.inWindow += 1;
    if (this.before > 0) this.gap(row.birth - this.before);
    this.before = row.birth;
  }

  /* Regular gaps differ from their mean by rounding. */
  gap(gap) {
    this.gaps.add(gap);
    this.beyond.add(gap > this.spacing * (1 + 1e-9) ? 1 : 0);
    this.short.add(gap < 0.5 * this.spacing ? 1 : 0);
  }

  endWindows(place) {
    for (; this.windowEnd <= place; this.windowEnd += this.life, this.inWindow = 0) this.window.add(this.inWindow);
  }

  /** Forget the dead and return how many are left. */
  leave(place) {
    let kept = 0;
    for (const row of this.live) if (row.death > place) this.live[kept++] = row;
    this.live.length = kept;
    return kept;
  }

  look(place) {
    this.counts.add(this.leave(place));
    let area = 0;
    for (const row of this.live) {
      area += this.pulse.area(place - row.birth, row.diameter, row.offset);
      this.alive.add(row.diameter);
      this.ages.add((place - row.birth) / (row.death - row.birth));
    }
    this.area.add(area);
  }

  /** Return the statistics by name. */
  figures() {
    return {
      areaMean: this.area.mean,
      areaStd: Math.sqrt(Math.max(0, this.area.variance)),
      skewness: this.area.skewness,
      countMean: this.counts.mean,
      countStd: Math.sqrt(Math.max(0, this.counts.variance)),
      lengthBiasedMean: this.alive.mean,
      ageMean: this.ages.mean,
      metMean: this.met.mean,
      diameterMean: this.born.mean,
      lifeMean: this.lives.mean,
      spacing: this.gaps.mean,
      gapsBeyondMean: this.beyond.mean,
      gapsBelowHalf: this.short.mean,
      birthsMean: this.window.mean,
      birthsVariance: this.window.variance,
    };
  }
}

let watch = null;
let watched = null;

/** Return what the run on the stage has shown so far. */
function seen(exact) {
  const { rows, reached } = rub.run;
  if (watched !== rows) [watch, watched] = [new Watch(exact, rub.model.pulseOf(rub.world)), rows];
  watch.follow(rows, reached);
  return { ...watch.figures(), ...rub.run.moments() };
}

/** Return what a whole run of settings shows over many lives, of which the stage shows the beginning. */
function measured(settings) {
  const births = new rub.model.Births(settings);
  const rows = [];
  const end = MOST_LIVES * births.contact.meanLife;
  births.until(end, rows);
  const whole = new Watch(rub.theory.exact(settings), births.contact.pulse);
  whole.follow(rows, end);
  return whole.figures();
}

Object.assign(lessons, { seen, measured, MOST_LIVES });
