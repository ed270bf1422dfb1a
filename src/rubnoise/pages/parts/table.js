/* The table of the lives in the window that the condition chooses: sorted by any column, a page at a time. */
const { lives } = view;
const { make } = rub;
const PAGE = 25;
const $ = (id) => document.getElementById(id);
const COLUMNS = [
  ["junction", view.one], ["birth_distance", "birth (µm)"], ["death_distance", "death (µm)"],
  ["diameter", "diameter (µm)"], ["max_area", view.data.flights ? "largest area (µm²)" : "full area (µm²)"], ["state", "state"],
];
let [by, falling, page, orders] = ["junction", false, 0, {}];

/* All rows in order of a column, worked out when it is first asked for. */
const order = () => {
  orders[by] ??= Uint32Array.from(lives.junction, (_, row) => row).sort((a, b) => lives[by][a] - lives[by][b] || a - b);
  return orders[by];
};

const sorted = (some) => {
  if (by === "junction") return falling ? some.reverse() : some;
  const isShown = new Uint8Array(lives.junction.length);
  for (const row of some) isShown[row] = 1;
  const rows = Array.from(order().filter((row) => isShown[row]));
  return falling ? rows.reverse() : rows;
};

const PLACES = Math.max(0, Math.ceil(3 - Math.log10(view.data.meanLife)));
const digits = (name, value) => (name.endsWith("distance") ? value.toFixed(PLACES) : String(Number(value.toPrecision(6))));
const textOf = (name, row) =>
  name === "state" ? view.stateNames(lives.state[row]).join(", ").replaceAll("_", " ") : digits(name, lives[name][row]);
const line = (row) => make("tr", { class: row === view.chosen && "chosen" }, ...COLUMNS.map(([name]) =>
  name === "junction" ? make("th", {}, view.opener(row)) : make("td", { text: textOf(name, row) })));

const sortBy = (name) => {
  [by, falling, page] = [name, name === by ? !falling : name !== "junction", 0];
  view.listLives();
  document.querySelector(`#lives thead [aria-sort]:nth-child(${COLUMNS.findIndex(([one]) => one === by) + 1}) button`).focus();
};

const head = () => {
  const names = COLUMNS.map(([name, label]) => {
    const isOwn = name === by;
    const text = label + (isOwn ? (falling ? " ▾" : " ▴") : "");
    const sort = make("button", { type: "button", text, onclick: () => sortBy(name) });
    return make("th", { "aria-sort": isOwn ? (falling ? "descending" : "ascending") : "none" }, sort);
  });
  document.querySelector("#lives thead").replaceChildren(make("tr", {}, ...names));
};

view.listLives = () => {
  const inWindow = view.visibleLives();
  const some = sorted(view.isKept ? inWindow.filter(view.isKept) : inWindow);
  const pages = Math.max(1, Math.ceil(some.length / PAGE));
  page = Math.min(page, pages - 1);
  const [first, last] = [page * PAGE, Math.min((page + 1) * PAGE, some.length)];
  head();
  document.querySelector("#lives tbody").replaceChildren(...some.slice(first, last).map(line));
  const of = some.length === inWindow.length ? "" : `${view.grouped(some.length)} of `;
  $("listed").textContent = `${of}${view.grouped(inWindow.length)} ${view.many} in this window` + (some.length ? `: ${view.grouped(first + 1)} to ${view.grouped(last)} below` : "");
  $("page-back").disabled = page === 0;
  $("page-on").disabled = page >= pages - 1;
};
const turn = (step) => { page += step; view.listLives(); };
$("page-back").addEventListener("click", () => turn(-1));
$("page-on").addEventListener("click", () => turn(1));
view.toFirstPage = () => { page = 0; };
