/* Where junctions meet on the stage: at random, and no two hills of one surface in one place. */
const PLACES = 5; // stream of random numbers
const TRIES = 200; // some twenty are needed
const places = new Map();
let wide = 1;
let high = 1;

/**
 * Return where a junction meets, in um: at random, from the seed and its row number. Hills of one surface do not
 * overlap: of junctions that are alive together, neither the lower nor the upper circles may. A place where they
 * would is drawn again; of TRIES that all overlap, the one that overlaps least is taken.
 */
function placeOf(row, into) {
  if (!places.has(row.id)) places.set(row.id, drawPlace(row));
  [into[0], into[1]] = places.get(row.id);
  return into;
}

function drawPlace(row) {
  const random = new rub.Random(rub.world.seed + row.id * 2 ** 21, PLACES);
  const margin = 0.9 * rub.exact().contact.diameter;
  const width = wide > 2 * margin ? wide - 2 * margin : 0;
  const height = high > 2 * margin ? high - 2 * margin : 0;
  const others = companions(row);
  let best = [0, 0];
  let least = Infinity;
  for (let i = 0; i < TRIES && least > 0; i += 1) {
    const [x, y] = [margin + random.uniform() * width, margin + random.uniform() * height];
    const overlap = overlapAt(x, y, others, least);
    if (overlap < least) [best, least] = [[x, y], overlap];
  }
  return best;
}

/**
 * Return what decides where a row may be beside others that are alive with it and have a place: their places, by how
 * much their lower circles lie on from these and their upper ones back, and the least square of a distance. These
 * stay as the surfaces slide.
 */
function companions(row) {
  const { run } = rub;
  const middle = row.birth + rub.halfLife(row.diameter, row.offset);
  const found = [];
  for (let i = run.after(row.birth - run.longest); i < run.rows.length; i += 1) {
    const other = run.rows[i];
    if (other.birth > row.death) break;
    const at = other !== row && other.death > row.birth && places.get(other.id);
    if (!at) continue;
    const along = 0.5 * (middle - other.birth - rub.halfLife(other.diameter, other.offset));
    const radii = 0.5 * (row.diameter + other.diameter);
    found.push({ x: at[0], y: at[1], along, across: 0.5 * (other.offset - row.offset), square: radii * radii });
  }
  return found;
}

/** Return by how much circles overlap at worst, in um^2, at most as much as others do; 0 for none. */
function overlapAt(x, y, others, most) {
  let worst = 0;
  for (const other of others) {
    for (const way of [1, -1]) {
      const apartX = x - other.x + way * other.along;
      const apartY = y - other.y + way * other.across;
      const overlap = other.square - apartX * apartX - apartY * apartY;
      if (overlap > worst) worst = overlap;
    }
    if (worst >= most) return most;
  }
  return worst;
}

/** Forget all places: those to come lie within so many um. */
function within(width, height) {
  [wide, high] = [width, height];
  places.clear();
}

rub.places = { placeOf, within };
