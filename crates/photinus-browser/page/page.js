// Pictures in, what the core tells of them out: drawn, and said in a table. WASM and FRAMES stand above, as base64.
"use strict";

const at = (id) => document.getElementById(id);
const form = at("setup");
const bytes = (base64) => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
const core = new WebAssembly.Instance(new WebAssembly.Module(bytes(WASM))).exports;
const MARKS = ["#56b4e9", "#e69f00", "#2fc49b", "#f07b3f", "#d98cb3", "#f0e442"];
const BRIGHTER = 4;

let picture = null; // { width, height, grey, name }
let playing = null;
let setUp = "";

/// The set-up that the form says, in the order of the core's arguments, for a picture of this size.
function wanted({ width, height }) {
  const number = (name) => Number(form.elements[name].value);
  return [width, height, number("focal"), number("arms"), number("radius"), number("leds"), number("splay")];
}

/// A picture's light, each pixel the mean of its colours.
async function decode(source, name) {
  const bitmap = await createImageBitmap(source);
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
  const grey = new Uint8Array(bitmap.width * bitmap.height);
  for (let i = 0; i < grey.length; i++) grey[i] = Math.round((data[4 * i] + data[4 * i + 1] + data[4 * i + 2]) / 3);
  return { width: bitmap.width, height: bitmap.height, grey, name };
}

function locate() {
  const asked = wanted(picture);
  if (String(asked) !== setUp) {
    setUp = core.photinus_set_up(...asked) ? String(asked) : "";
    if (!setUp) return { wrong: "There is no such camera or no such ring of LEDs: correct the numbers below." };
  }
  new Uint8Array(core.memory.buffer, core.photinus_pixels(), picture.grey.length).set(picture.grey);
  const begun = performance.now();
  const length = core.photinus_locate(form.elements.level.checked ? 1 : 0);
  const took_ms = performance.now() - begun;
  const text = new TextDecoder().decode(new Uint8Array(core.memory.buffer, core.photinus_told(), length));
  return { ...JSON.parse(text), took_ms };
}

function show() {
  if (!picture) return;
  const told = locate();
  drawPicture(told);
  if (told.wrong) {
    at("said").textContent = told.wrong;
    return;
  }
  drawAbove(told);
  tell(told);
}

function drawPicture({ spots = [], neighbours = [] }) {
  const canvas = at("picture");
  const { width, height, grey } = picture;
  [canvas.width, canvas.height] = [width, height];
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  const pixels = new Uint32Array(image.data.buffer); // 0xAABBGGRR
  grey.forEach((level, i) => (pixels[i] = 0xff000000 | (Math.min(255, BRIGHTER * level) * 0x010101)));
  context.putImageData(image, 0, 0);
  const scale = width / 752;
  const circle = (spot, colour) => {
    context.strokeStyle = colour;
    context.beginPath();
    context.arc(spot.u_px, spot.v_px, 9 * scale, 0, 2 * Math.PI);
    context.stroke();
  };
  context.lineWidth = 2 * scale;
  spots.forEach((spot) => circle(spot, "#9aa4ac"));
  context.font = `${22 * scale}px system-ui, sans-serif`;
  neighbours.forEach((neighbour, index) => {
    const colour = MARKS[index % MARKS.length];
    const members = neighbour.spots.map((spot) => spots[spot]).sort((a, b) => a.u_px - b.u_px);
    members.forEach((spot) => circle(spot, colour));
    context.beginPath();
    members.forEach((spot) => context.lineTo(spot.u_px, spot.v_px));
    context.stroke();
    const { estimate } = neighbour.distance_m;
    const label = estimate === undefined ? `${index + 1}` : `${index + 1}: ${estimate.toFixed(1)} m`;
    const u = Math.min(members[0].u_px, width - 130 * scale);
    const above = Math.min(...members.map((spot) => spot.v_px)) - 18 * scale;
    context.fillStyle = colour;
    context.fillText(label, u, above > 20 * scale ? above : above + 60 * scale);
  });
}

function drawAbove({ neighbours }) {
  const canvas = at("above");
  const context = canvas.getContext("2d");
  const [width, height] = [canvas.width, canvas.height];
  context.clearRect(0, 0, width, height);
  const farthest = Math.max(10, ...neighbours.map(({ distance_m: d }) => 1.15 * Math.min(d.max ?? d.estimate, 1.6 * d.estimate) || 0));
  const scale = (height - 40) / farthest;
  const place = (bearing, distance) => {
    const level = Math.hypot(bearing[0], bearing[2]) || 1;
    return [width / 2 + (bearing[0] / level) * distance * scale, height - 20 - (bearing[2] / level) * distance * scale];
  };
  context.font = "18px system-ui, sans-serif";
  context.lineWidth = 1;
  const step = farthest > 24 ? 10 : farthest > 12 ? 5 : 2;
  for (let ring = step; ring <= farthest; ring += step) {
    context.strokeStyle = "#39424a";
    context.beginPath();
    context.arc(width / 2, height - 20, ring * scale, Math.PI, 2 * Math.PI);
    context.stroke();
    context.fillStyle = "#8b959d";
    context.fillText(`${ring} m`, width / 2 + 4, height - 24 - ring * scale);
  }
  const segment = (bearing, from, to, thick, colour) => {
    context.strokeStyle = colour;
    context.lineWidth = thick;
    context.beginPath();
    context.moveTo(...place(bearing, from));
    context.lineTo(...place(bearing, to));
    context.stroke();
  };
  neighbours.forEach(({ bearing, distance_m: d }, index) => {
    const colour = MARKS[index % MARKS.length];
    if (d.max !== null) segment(bearing, d.min, Math.min(d.max, 2 * farthest), 10, `${colour}55`);
    if (d.estimate === undefined) return;
    segment(bearing, Math.max(0, d.estimate - 2 * d.sigma), d.estimate + 2 * d.sigma, 3, colour);
    const [x, y] = place(bearing, d.estimate);
    context.fillStyle = colour;
    context.beginPath();
    context.arc(x, y, 7, 0, 2 * Math.PI);
    context.fill();
    context.fillText(`${index + 1}`, x + 12, y + 6);
  });
  context.fillStyle = "#e4e7ea";
  context.beginPath();
  context.arc(width / 2, height - 20, 5, 0, 2 * Math.PI);
  context.fill();
}

function tell({ spots, rejected, neighbours, took_ms }) {
  const fixed = (number, digits = 2) => (number === undefined || number === null ? "-" : number.toFixed(digits));
  const side = (rad, one, other) => `${fixed((180 / Math.PI) * Math.abs(rad), 1)} ${rad < 0 ? other : one}`;
  const row = ({ bearing, distance_m: d, probability, spots: members }, index) => [
    index + 1,
    fixed(d.estimate),
    fixed(d.sigma),
    `${fixed(d.min)} to ${fixed(d.max)}`,
    `${side(Math.atan2(bearing[0], bearing[2]), "right", "left")}, ${side(-Math.asin(bearing[1]), "up", "down")}`,
    `${fixed(100 * probability, 1)} %`,
    members.length,
  ];
  const cells = (values) => values.map((value) => Object.assign(document.createElement("td"), { textContent: value }));
  const line = (values) => {
    const element = document.createElement("tr");
    element.append(...cells(values));
    return element;
  };
  at("rows").replaceChildren(...neighbours.map(row).map(line));
  const count = (number, word) => `${number} ${word}${number === 1 ? "" : "s"}`;
  at("said").textContent =
    `${picture.name}: ${count(spots.length, "spot")}, ${count(rejected, "bright region")} rejected, ` +
    `${count(neighbours.length, "neighbour")}, in ${took_ms.toFixed(1)} ms.`;
}

async function open(source, name) {
  stop();
  try {
    picture = await decode(source, name);
    at("shown").textContent = "";
    show();
  } catch (error) {
    at("said").textContent = `${name} is no picture that this browser reads (${error.message}).`;
  }
}

const frames = [];
async function seek(number) {
  at("time").value = number;
  frames[number] ??= await decode(new Blob([bytes(FRAMES[number])], { type: "image/png" }), `frame ${number + 1} of ${FRAMES.length}`);
  picture = frames[number];
  at("shown").textContent = `${number + 1} / ${FRAMES.length}`;
  show();
}

function stop() {
  clearInterval(playing);
  playing = null;
  at("play").textContent = "Play";
}

at("play").onclick = () => {
  if (playing) return stop();
  at("play").textContent = "Pause";
  playing = setInterval(() => seek((Number(at("time").value) + 1) % FRAMES.length), 170);
};
at("time").max = FRAMES.length - 1;
at("time").oninput = () => {
  stop();
  seek(Number(at("time").value));
};
at("file").onchange = ({ target }) => target.files[0] && open(target.files[0], target.files[0].name);

form.elements.camera.onchange = ({ target }) => {
  if (target.value !== "other") form.elements.focal.value = target.value;
};
form.elements.airframe.onchange = ({ target }) => {
  if (target.value === "other") return;
  const [arms, radius, leds, splay] = target.value.split(",");
  Object.entries({ arms, radius, leds, splay }).forEach(([name, value]) => (form.elements[name].value = value));
};
form.onchange = show;
form.onsubmit = (event) => event.preventDefault();

const drop = at("drop");
["dragenter", "dragover"].forEach((kind) =>
  addEventListener(kind, (event) => (event.preventDefault(), drop.classList.add("over"))),
);
addEventListener("dragleave", () => drop.classList.remove("over"));
addEventListener("drop", (event) => {
  event.preventDefault();
  drop.classList.remove("over");
  const [file] = event.dataTransfer.files;
  if (file) open(file, file.name);
});

// A link may say which frame is shown first: index.html#12
seek(Math.min(Math.max(Number(location.hash.slice(1)) || 1, 1), FRAMES.length) - 1);
