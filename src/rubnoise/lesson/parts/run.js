/* The run on the page: where it is, how it plays, who is alive, what has been seen so far. */
/* No fraction of whole numbers: ticks would keep meeting regular births in the same phase. */
const TICKS_PER_LIFE = 30 * (1 + Math.sqrt(5));
const MOST_LIVES = 2000;
const MOST_ROWS = 100000;
/* Work of a slider that pushes back, in units of some microseconds: in one frame, and at one jump. */
const FRAME_WORK = 6000;
const JUMP_WORK = 400000;

const run = {
  /** Every junction drawn so far, {id, birth, diameter, death, strength}, in order of birth. */
  get rows() {
    return this.trace.rows;
  },
  /** Where the slider is on the surface, and the farthest it has come: the two differ where it has run back. */
  distance: 0,
  reached: 0,
  /** Seconds since the start, and a slider that pushes back: null where the drive's speed is constant. */
  time: 0,
  motion: null,
  /** A slider that is free to leave its contact, or null. */
  flight: null,
  goal: -1,
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
    this.couple(startOf(world, contact));
    if (!keep) rub.emit('reset', world);
  },

  /* Another slider on the same contact begins where the last one did, and comes to where that was. */
  couple(start) {
    const { world } = rub;
    const { trace } = this;
    this.motion = null;
    this.flight = world.support === 'free' ? new rub.flight.Flight(world) : null;
    this.goal = -1;
    this.time = 0;
    if (world.coupling !== 'two-way') {
      this.distance = this.reached;
      this.flight?.until(this.reached);
      return;
    }
    const field = new rub.Field(world, trace.source, trace.rows, this.end);
    this.motion = new rub.Motion(world, field, start);
    const { reached } = this;
    this.moveTo(0);
    this.chase(reached, JUMP_WORK);
    this.liveAt(this.distance, this.living);
  },

  /** Put the run of a slider that pushes back to a time that has been computed. */
  moveTo(time) {
    const { motion } = this;
    this.time = Math.max(0, Math.min(time, motion.time));
    this.distance = motion.placeAt(this.time);
    this.reached = Math.min(this.end, Math.max(motion.at('farthest', this.time), this.distance));
  },

  /** Compute towards a distance; what is not reached with so much work is the goal of the next frames. */
  chase(distance, work) {
    const { motion } = this;
    const there = motion.until({ distance, work });
    this.goal = there ? -1 : distance;
    this.moveTo(there && motion.reached >= distance ? motion.timeAt(distance) : motion.time);
    if (there && motion.reached >= distance) this.distance = this.reached = distance;
  },

  begin(world, contact) {
    const record = rub.replaying ? rub.lesson.record : null;
    const source = record ? new rub.model.Replay(record, world) : new rub.model.Births({ ...world });
    const tick = record ? record.tick : contact.meanLife / TICKS_PER_LIFE;
    const most = Math.min(rub.lesson.distance, MOST_LIVES * contact.meanLife, MOST_ROWS * contact.spacing);
    this.end = record ? record.distance : most;
    this.longest = source.longest;
    this.window = 4 * contact.meanLife;
    const last = Math.floor(this.end / tick + 1e-9);
    this.trace = new rub.Trace({ ...world }, source, tick, last, startOf(world, contact));
    this.distance = 0;
    this.reached = 0;
    this.selected = -1;
    this.trace.until(1);
    this.living = [];
    this.liveAt(0, this.living);
  },

  play() {
    if (this.isOver) this.goTo(0);
    this.playing = true;
    rub.emit('playing', true);
  },

  pause() {
    this.playing = false;
    rub.emit('playing', false);
  },

  get isOver() {
    const { motion } = this;
    return this.reached >= this.end || Boolean(motion?.isOver && this.time >= motion.time);
  },

  /** Slide on for some seconds of the clock on the wall. */
  advance(seconds) {
    if (this.goal >= 0) this.goOn();
    else if (this.playing && this.motion) this.slideFor((this.pace * seconds) / rub.world.speed);
    else if (this.playing) this.slideTo(Math.min(this.distance + this.pace * seconds, this.end));
    if (this.playing && this.isOver) this.pause();
  },

  goOn() {
    this.chase(this.goal, FRAME_WORK);
    this.passed();
  },

  /** Let a slider that pushes back go on for seconds of its own time; what is too much for a frame is left out. */
  slideFor(seconds) {
    const wanted = this.time + seconds;
    this.motion.until({ time: wanted, work: FRAME_WORK });
    this.moveTo(wanted);
    this.passed();
  },

  /** Slide forward to a distance. */
  slideTo(distance) {
    if (this.motion) this.chase(Math.min(distance, this.end), JUMP_WORK);
    else this.distance = this.reached = distance;
    this.passed();
  },

  passed() {
    this.prepare(this.reached);
    this.liveAt(this.distance, this.living);
    rub.emit('tick', this.distance);
  },

  /* Junctions that are about to meet are on the stage before they touch. */
  prepare(distance) {
    this.flight?.until(distance);
    this.trace.until(Math.ceil(distance / this.trace.tick) + 1);
    this.trace.source.until(distance + 0.5 * this.window, this.trace.rows);
  },

  /** Jump to a distance, forward or back. */
  goTo(distance) {
    const wanted = Math.min(Math.max(0, distance), this.end);
    if (this.motion) this.chase(wanted, JUMP_WORK);
    else this.distance = this.reached = wanted;
    this.passed();
  },

  /** Go on to the next birth or death and stop there; return the kind and the row, or null at the end. */
  stepEvent() {
    if (this.playing) this.pause();
    this.prepare(this.reached);
    if (this.flight) return this.stepFlight();
    const birth = this.rows[this.after(this.reached)];
    let next = birth && birth.birth <= this.end ? { kind: 'birth', row: birth, distance: birth.birth } : null;
    for (const row of this.liveAt(this.reached)) {
      if (row.death <= this.end && (!next || row.death < next.distance)) {
        next = { kind: 'death', row, distance: row.death };
      }
    }
    if (next) this.slideTo(next.distance);
    return next;
  },

  /** Go on to where the slider leaves its contact or comes back to it. */
  stepFlight() {
    const next = this.flight.next(this.reached, this.end);
    if (next) this.slideTo(next.distance);
    return next;
  },

  /** Return the number of the first row born after a distance. */
  after(distance) {
    return rub.firstPlace(this.rows.length, (i) => this.rows[i].birth > distance);
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

  /** Return the number of the last tick that has been passed. */
  get ticksSeen() {
    return Math.min(Math.floor(this.reached / this.trace.tick + 1e-9), this.trace.ready - 1);
  },

  /** Return real contact area in um^2 at a distance, from the rows. */
  areaAt(distance) {
    const { area } = this.trace.pulse;
    const areaOf = (row) => area(distance - row.birth, row.diameter, row.offset);
    return this.liveAt(distance).reduce((sum, row) => sum + areaOf(row), 0);
  },
};

/** Where the slider starts: at rest under the mean force, or at zero. */
function startOf(world, { birthRate, pulse, sizes }) {
  const start = rub.lesson.sliderStart === 'rest' ? 0 : 1;
  return (start * world.strength * birthRate * pulse.lifeIntegrals[0] * sizes.moment(3)) / world.stiffness;
}

rub.run = run;
