/* Settings in the address: what differs from the page's own stands behind #, so that a copy brings it back. */
const entries = () => new Map(new URLSearchParams(location.hash.slice(1)));

/** Replace what stands behind # without a step in the browser's history. */
function write(map) {
  const text = new URLSearchParams([...map]).toString();
  history.replaceState(null, '', text ? `#${text}` : location.pathname + location.search);
}

/** Return what stands behind # under a name, or undefined; with a value, put it there (null takes it away). */
rub.fragment = (name, value) => {
  const map = entries();
  if (value === undefined) return map.get(name);
  if (value === null) map.delete(name);
  else map.set(name, String(value));
  write(map);
  return value;
};

/** Write the settings that differ from the page's own. */
function share() {
  const map = entries();
  for (const [key, value] of Object.entries(rub.world)) {
    if (value === rub.given[key]) map.delete(key);
    else map.set(key, String(value));
  }
  write(map);
}

/** Return the settings that stand behind #; what is none is left alone. */
function shared() {
  const found = {};
  for (const [key, text] of entries()) {
    if (!(key in rub.given)) continue;
    found[key] = typeof rub.given[key] === 'number' ? Number(text) : text;
  }
  return found;
}

/** Take over the settings behind #, now and whenever the address changes. */
rub.followFragment = () => {
  const follow = () => {
    const wanted = { ...rub.given, ...shared() };
    if (Object.keys(wanted).some((key) => wanted[key] !== rub.world[key])) rub.set(wanted);
  };
  follow();
  addEventListener('hashchange', follow);
  /* Browsers allow few changes of the address in a while, and a knob makes many. */
  let waiting = 0;
  rub.on('settings', () => {
    clearTimeout(waiting);
    waiting = setTimeout(share, 250);
  });
};
