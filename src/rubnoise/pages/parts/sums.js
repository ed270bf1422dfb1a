/* Area, count and force where the page holds no ticks: sums over the lives, as the run makes them. */
const { data } = view;
const { birth_distance: birth, death_distance: death, shear_strength: strength } = view.lives;
/* Ticks times live junctions that are summed while a window moves. */
const MOST = 1500000;
/* No row says the area of a touch of free motion. */
const held = (from, to) => !data.flights && from >= data.junctions.start && to <= data.junctions.stop;
let last = null;

/** The sums at every tick between two distances, or null where they are too many or lives are not in the page. */
view.summed = (from, to) => {
  const first = Math.max(Math.floor(from / data.tick), 0);
  const count = Math.min(Math.ceil(to / data.tick), Math.floor(data.distance / data.tick + 1e-9)) - first + 1;
  if (!held(from, to) || count * Math.max(data.count?.mean ?? 1, 1) > MOST) return null;
  if (last !== null && last.first === first && last.count === count) return last;
  const found = { first, count, real_contact_area: new Float64Array(count), junction_count: new Float64Array(count) };
  if (strength && !data.loaded) found.friction_force = new Float64Array(count);
  for (const row of view.livesBetween(first * data.tick, (first + count) * data.tick)) {
    const begin = Math.max(Math.ceil(birth[row] / data.tick) - first, 0);
    for (let i = begin; i < count; i += 1) {
      const s = (first + i) * data.tick;
      if (s >= death[row]) break;
      const area = view.areaAtAge(row, s - birth[row]);
      found.real_contact_area[i] += area;
      found.junction_count[i] += 1;
      if (found.friction_force) found.friction_force[i] += strength[row] * area;
    }
  }
  last = found;
  return found;
};

/** One of the sums at a distance; null where the page cannot know it. */
view.sumAt = (name, s) => {
  if (!held(s, s) || (name === "friction_force" && (data.loaded || !strength))) return null;
  const some = view.aliveAt(s);
  if (name === "junction_count") return some.length;
  return some.reduce((sum, row) => sum + (name === "friction_force" ? strength[row] : 1) * view.areaAtAge(row, s - birth[row]), 0);
};
