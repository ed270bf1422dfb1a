'use strict';
/* The run on the page: where it is, how it plays, who is alive, what has been seen so far. */
(() => {
  const rub = (globalThis.rub ??= {});
  /* No fraction of whole numbers: ticks would keep meeting regular births in the same phase. */
  const TICKS_PER_LIFE = 30 * (1 + Math.sqrt(5));
  const MOST_LIVES = 2000;
  const MOST_ROWS = 100000;

  const run = {
    /** Every junction drawn so far, {id, birth, diameter, death, strength}, in order of birth. */
    get rows() {
      return this.trace.rows;
    },
    distance: 0,
    playing: false,
    pace: 5,
    selected: -1,
    trace: null,
    living: [],

    /** Make a run of the settings; keep leaves the distance where it was. */
    renew({ keep }) {
      const { world } = rub;
      const contact = rub.model.contact(world);
      if (keep && this.trace) this.trace.reslide({ ...world }, startOf(world, contact));
      else this.begin(world, contact);
      if (!keep) rub.tell('reset', world);
    },

    begin(world, contact) {
      const source = rub.replaying
        ? new rub.model.Replay(rub.lesson.record, world)
        : new rub.model.Births({ ...world });
      const record = rub.replaying ? rub.lesson.record : null;
      const tick = record ? record.tick : contact.meanLife / TICKS_PER_LIFE;
      const most = Math.min(rub.lesson.distance, MOST_LIVES * contact.meanLife, MOST_ROWS * contact.spacing);
      this.end = record ? record.distance : most;
      this.longest = source.longest;
      this.window = 4 * contact.meanLife;
      this.trace = new rub.Trace(
        { ...world },
        source,
        tick,
        Math.floor(this.end / tick + 1e-9),
        startOf(world, contact),
      );
      this.distance = 0;
      this.selected = -1;
      this.trace.until(1);
      this.living = [];
      this.liveAt(0, this.living);
    },

    play() {
      if (this.distance >= this.end) this.goTo(0);
      this.playing = true;
      rub.tell('playing', true);
    },

    pause() {
      this.playing = false;
      rub.tell('playing', false);
    },

    /** Slide on for some seconds of the clock on the wall. */
    advance(seconds) {
      if (!this.playing) return;
      this.slideTo(Math.min(this.distance + this.pace * seconds, this.end));
      if (this.distance >= this.end) this.pause();
    },

    /** Slide forward to a distance, and tell of every birth and death on the way. */
    slideTo(distance) {
      const from = this.distance;
      this.prepare(distance);
      this.distance = distance;
      if (rub.heard('death')) this.tellDeaths(distance);
      if (rub.heard('birth')) this.tellBirths(from, distance);
      this.liveAt(distance, this.living);
      rub.tell('tick', distance);
    },

    tellDeaths(distance) {
      for (const row of this.living) if (row.death <= distance) rub.tell('death', row);
    },

    tellBirths(from, distance) {
      for (let i = this.after(from); i < this.rows.length && this.rows[i].birth <= distance; i += 1) {
        rub.tell('birth', this.rows[i]);
      }
    },

    /* Junctions that are about to meet are on the stage before they touch. */
    prepare(distance) {
      this.trace.until(Math.ceil(distance / this.trace.tick) + 1);
      this.trace.source.until(distance + 0.5 * this.window, this.trace.rows);
    },

    /** Jump to a distance, forward or back. */
    goTo(distance) {
      this.prepare(Math.min(Math.max(0, distance), this.end));
      this.distance = Math.min(Math.max(0, distance), this.end);
      this.liveAt(this.distance, this.living);
      rub.tell('jump', this.distance);
      rub.tell('tick', this.distance);
    },

    /** Go on to the next birth or death and stop there; return the kind and the row, or null at the end. */
    stepEvent() {
      if (this.playing) this.pause();
      this.prepare(this.distance);
      const birth = this.rows[this.after(this.distance)];
      let next = birth && birth.birth <= this.end ? { kind: 'birth', row: birth, distance: birth.birth } : null;
      for (const row of this.living) {
        if (row.death <= this.end && (!next || row.death < next.distance)) {
          next = { kind: 'death', row, distance: row.death };
        }
      }
      if (next) this.slideTo(next.distance);
      return next;
    },

    /** Return the number of the first row born after a distance. */
    after(distance) {
      const { rows } = this;
      let low = 0;
      let high = rows.length;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (rows[middle].birth <= distance) low = middle + 1;
        else high = middle;
      }
      return low;
    },

    /** Put the rows that are alive at a distance into a list, in order of birth, and return it. */
    liveAt(distance, into = []) {
      into.length = 0;
      for (let i = this.after(distance - this.longest); i < this.rows.length; i += 1) {
        const row = this.rows[i];
        if (row.birth > distance) break;
        if (row.death > distance) into.push(row);
      }
      return into;
    },

    /** Return the rows that are alive now. */
    live() {
      return this.living.slice();
    },

    /** Return the number of the last tick that has been passed. */
    get ticksSeen() {
      return Math.min(Math.floor(this.distance / this.trace.tick + 1e-9), this.trace.ready - 1);
    },

    /** Return real contact area in um^2 at a distance, from the rows. */
    areaAt(distance) {
      const { area } = this.trace.pulse;
      return this.liveAt(distance).reduce((sum, row) => sum + area(distance - row.birth, row.diameter), 0);
    },
  };

  /** Where the slider starts: at rest under the mean force, or at zero. */
  function startOf(world, { birthRate, pulse, sizes }) {
    const start = rub.lesson.sliderStart === 'rest' ? 0 : 1;
    return (start * world.strength * birthRate * pulse.lifeIntegral(1) * sizes.moment(3)) / world.stiffness;
  }

  rub.run = run;
})();
