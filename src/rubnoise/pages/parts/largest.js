/* Where the run has its largest, and who was alive then. */
const { data } = view;
const $ = (id) => document.getElementById(id);
const MOST_NAMED = 60;

/** A button that shows a junction by its row. */
view.opener = (row) => {
  const junction = view.lives.junction[row];
  const label = `Show ${view.one} ${junction}`;
  return rub.make("button", { type: "button", text: junction, "aria-label": label, onclick: () => view.visit(row) });
};

/** Buttons of junctions by their rows, of many the first. */
view.named = (rows) => [
  ...rows.slice(0, MOST_NAMED).map(view.opener),
  ...(rows.length > MOST_NAMED ? [` and ${view.grouped(rows.length - MOST_NAMED)} more`] : []),
];

const tell = (text, s) => {
  $("largest").textContent = text;
  $("then").replaceChildren();
  view.mark = s;
  if (s === null) return;
  const some = view.aliveAt(s);
  $("largest").textContent += ` ${view.grouped(some.length)} alive then:`;
  $("then").replaceChildren(...view.named(some));
};
const around = (s) => {
  const half = 1.5 * data.meanLife;
  view.show(s - half, s + half);
};

const { junction, force, stick, impact } = data.extremes;
const SHOWN = {
  "largest-junction": junction === null ? null : () => {
    const row = view.rowOf(junction);
    const { diameter, max_area: area } = view.lives;
    view.visit(row);
    tell(`${$("largest-junction").textContent}: ${junction}, diameter ${view.number(diameter[row])} µm, ${data.flights ? "largest" : "full"} area ${view.number(area[row])} µm².`, view.life(row).peak);
  },
  "largest-force": () => {
    around(force.distance);
    const [what, unit] = force.name === "friction_force" ? ["force", "µN"] : ["real contact area", "µm²"];
    tell(`Largest ${what}: ${view.number(force.value)} ${unit}, at s = ${view.number(force.distance)} µm.`, force.distance);
  },
  "longest-stick": stick === null ? null : () => {
    around(stick.distance);
    tell(`Longest stick: ${view.number(stick.end - stick.begin)} s, from t = ${view.number(stick.begin)} s, at s = ${view.number(stick.distance)} µm.`, stick.distance);
  },
  "hardest-impact": impact === null ? null : () => {
    around(impact.distance);
    tell(`Hardest impact: sliding and falling together, the overlap grows at ${view.number(impact.speed)} µm/s, at t = ${view.number(impact.time)} s, s = ${view.number(impact.distance)} µm.`, impact.distance);
  },
};
if (force.name !== "friction_force") $("largest-force").textContent = "Largest area";
for (const [id, act] of Object.entries(SHOWN)) {
  $(id).hidden = act === null || (id === "largest-junction" && view.rowOf(junction) === null);
  if (act !== null) $(id).addEventListener("click", () => act());
}
