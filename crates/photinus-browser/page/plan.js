// A set-up in, how far and how exactly it sees out: drawn and said in tables. It is worked out beside the page's own thread.

const wanted = at("wanted");
const partsText = text(core.photinus_parts());
const example = text(core.photinus_example());

for (const kind of ["led", "filter", "lens", "sensor"]) {
  const names = [...partsText.matchAll(new RegExp(`^\\[${kind}\\.(.+)\\]$`, "gm"))].map(([, name]) => name);
  wanted.elements[kind].append(...names.map((name) => new Option(name)));
}

/// The form as the file that `photinus plan` takes: its example, with what the form says.
function asFile() {
  const of = (name) => wanted.elements[name].value;
  const splay = of("leds") === "1" ? "0.0" : of("splay");
  const said = {
    "": { exposure_us: of("exposure") },
    led: { part: `"${of("led")}"`, current_ma: of("current") },
    filter: { part: `"${of("filter")}"` },
    lens: { part: `"${of("lens")}"` },
    sensor: { part: `"${of("sensor")}"` },
    airframe: { ring: `{ arms = ${of("arms")}, radius_m = ${of("radius")}, leds_per_arm = ${of("leds")}, splay_deg = ${splay} }` },
    sky: { kind: `"${of("sky")}"`, sun_deg: of("sun") },
    wanted: { range_m: of("range") },
  };
  let table = "";
  const line = (written) => {
    table = /^\[(.+)\]/.exec(written)?.[1] ?? table;
    const key = /^(\w+) =/.exec(written)?.[1];
    const value = said[table]?.[key];
    return value === undefined ? written : `${key} = ${value}`;
  };
  return example.split("\n").map(line).join("\n");
}

/// Works out a plan where it stops nothing else: a worker's own core.
function planned(file) {
  const work = async ({ data: { module, file } }) => {
    const { exports } = (await WebAssembly.instantiate(module)).instance;
    const written = new TextEncoder().encode(file);
    const place = exports.photinus_text(written.length);
    new Uint8Array(exports.memory.buffer, place, written.length).set(written);
    const length = exports.photinus_plan();
    postMessage(new TextDecoder().decode(new Uint8Array(exports.memory.buffer, exports.photinus_told(), length)));
  };
  const url = URL.createObjectURL(new Blob([`onmessage = ${work}`], { type: "text/javascript" }));
  const worker = new Worker(url);
  return new Promise((told, fail) => {
    worker.onmessage = ({ data }) => told(JSON.parse(data));
    worker.onerror = ({ message }) => fail(new Error(message));
    worker.postMessage({ module: MODULE, file });
  }).finally(() => (worker.terminate(), URL.revokeObjectURL(url)));
}

async function plan() {
  at("ask").disabled = true;
  at("planned").textContent = "Working it out: some seconds.";
  try {
    const begun = performance.now();
    const told = await planned(at("file-of-plan").value);
    at("plan").hidden = told.wrong !== undefined;
    at("planned").textContent = told.wrong ?? `Worked out in ${((performance.now() - begun) / 1000).toFixed(1)} s.`;
    if (!told.wrong) showPlan(told);
  } catch (error) {
    at("planned").textContent = `The plan stopped: ${error.message}`;
  }
  at("ask").disabled = false;
}

const DEG = 180 / Math.PI;

function showPlan({ direction, distance, yaw_turn_rad, over_distance: over, layouts, battery, eyes }) {
  const reach = ({ nearly_all_m, half_m }) =>
    (nearly_all_m > 0 ? `in 95 of 100 frames to ${fixed(nearly_all_m, 1)} m, in half of them to ` : "in half of all frames to ") + `${fixed(half_m, 1)} m`;
  const turn = Math.round(DEG * yaw_turn_rad);
  const said = {
    "A direction (one spot)": reach(direction),
    "A distance (two spots)": reach(distance),
    Yaw: turn === 360 ? "in full" : `modulo ${turn} deg; in full with blinked signals`,
  };
  const term = ([name, value]) => [
    Object.assign(document.createElement("dt"), { textContent: name }),
    Object.assign(document.createElement("dd"), { textContent: value }),
  ];
  at("reach").replaceChildren(...Object.entries(said).flatMap(term));
  const along = (key, factor = 1) => over.filter((at) => at[key] !== null).map((at) => [at.distance_m, factor * at[key]]);
  at("errors").innerHTML = chart("distance, m", "error of the distance, m", true, [
    ["half are within", along("distance_error_m"), "#0072b2"],
    ["root mean square", along("distance_rms_m"), "#d55e00"],
  ]);
  at("found").innerHTML = chart("distance, m", "share of frames, %", false, [
    ["one spot: a direction", along("one", 100), "#009e73"],
    ["two spots: a distance", along("two", 100), "#0072b2"],
  ]);
  fill(
    at("layouts"),
    layouts.map((layout) => [
      layout.name,
      fixed(100 * layout.two, 0),
      fixed(layout.distance_error_m, 3),
      fixed(layout.half_m, 1),
      fixed(layout.yaw_rms_rad === null ? null : DEG * layout.yaw_rms_rad, 1),
      fixed(DEG * layout.yaw_turn_rad, 0),
    ]),
  );
  at("battery").textContent = battery
    ? `Light takes ${fixed(battery.light_w, 1)} W, ${fixed(100 * battery.share, 1)} % of hovering: ${fixed(battery.lost_min, 1)} of ` +
      `${fixed(battery.dark_min, 0)} min are lost; half of it with words that are on half of the time.`
    : "";
  at("eyes").textContent =
    `Eyes: ${fixed(eyes.at_assessment_w_m2, 1)} W/m^2 of near ultraviolet at 0.2 m, ${eyes.risk_group ? `risk group ${eyes.risk_group}` : "exempt"} ` +
    `(IEC 62471:2006). Keep ${fixed(eyes.long_m)} m away to look into it for more than 1000 s, ${fixed(eyes.day_m)} m to work beside it for 8 h.`;
}

/// Curves over distance as SVG on white, the distance on a scale of ratios and the other axis too if `isRatio`.
function chart(across, up, isRatio, curves) {
  const [width, height, left, low] = [720, 360, 70, 50];
  const points = curves.flatMap(([, points]) => points);
  const span = (values) => [Math.min(...values), Math.max(...values)];
  const [x0, x1] = span(points.map(([x]) => x));
  const [y0, y1] = isRatio ? span(points.map(([, y]) => y)) : [0, 100];
  const share = (value, from, to, isRatio) => (isRatio ? Math.log(value / from) / Math.log(to / from) : (value - from) / (to - from));
  const x = (value) => left + share(value, x0, x1, true) * (width - left - 20);
  const y = (value) => height - low - share(value, y0, y1, isRatio) * (height - low - 20);
  const decades = (from, to) => {
    const found = [];
    for (let power = -4; power < 4; power++)
      for (const step of [1, 2, 5]) if (step * 10 ** power >= from * 0.999 && step * 10 ** power <= to * 1.001) found.push(step * 10 ** power);
    return found;
  };
  const label = (value) => `${Number(value.toPrecision(2))}`;
  const upright = isRatio ? decades(y0, y1) : [0, 25, 50, 75, 100];
  const lines = [
    ...decades(x0, x1).map((at) => `<path d="M${x(at)} 20V${height - low}"/><text x="${x(at)}" y="${height - low + 20}" text-anchor="middle">${label(at)}</text>`),
    ...upright.map((at) => `<path d="M${left} ${y(at)}H${width - 20}"/><text x="${left - 8}" y="${y(at) + 5}" text-anchor="end">${label(at)}</text>`),
  ];
  const drawn = curves.map(([name, points, colour], index) => {
    const path = points.map(([px, py], i) => `${i ? "L" : "M"}${x(px).toFixed(1)} ${y(py).toFixed(1)}`).join("");
    const [u, v] = isRatio ? [left + 14, 40 + 22 * index] : [left + 14, height - low - 36 + 22 * index];
    return `<path d="${path}" fill="none" stroke="${colour}" stroke-width="2.5"/><text x="${u}" y="${v}" fill="${colour}">${name}</text>`;
  });
  return `<svg viewBox="0 0 ${width} ${height}" role="img" aria-label="${up} over ${across}" style="background:#fff" font-size="14">
<g stroke="#d5dade" fill="none">${lines.join("").replaceAll("<text", '<text stroke="none" fill="#5b6268"')}</g>${drawn.join("")}
<text x="${(left + width) / 2}" y="${height - 8}" text-anchor="middle" fill="#1d2125">${across}</text>
<text transform="translate(18 ${height / 2}) rotate(-90)" text-anchor="middle" fill="#1d2125">${up}</text></svg>`;
}

const write = () => (at("file-of-plan").value = asFile());
wanted.onchange = ({ target }) => target.id !== "file-of-plan" && write();
wanted.onsubmit = (event) => {
  event.preventDefault();
  plan();
};
write();
