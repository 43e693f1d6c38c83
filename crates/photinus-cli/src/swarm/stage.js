const film = JSON.parse(document.getElementById("film").textContent);
const stage = document.querySelector(".stage");
const [above, space, view] = ["above", "space", "view"].map(id => document.getElementById(id));
const slider = stage.querySelector("input"), button = stage.querySelector("button");
const clock = stage.querySelector("output"), choice = stage.querySelector("select");
film.names.forEach((name, index) => choice.add(new Option(name, index)));
slider.max = film.shots.length - 1;
let playing = true, turn = 0.6, lift = 0.5, zoom = 1;

// what the camera of the page has to hold: everybody, at all times
const reach = [0, 1, 2].map(axis => {
  const values = film.shots.flatMap(shot => shot.p.map(place => place[axis]));
  return [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)];
});
const middle = reach.map(([low, high]) => (low + high) / 2);
const half = Math.max(3, ...reach.slice(0, 2).map(([low, high]) => (high - low) / 2)) * 1.12;
const square = [1, 2, 5, 10, 20, 50, 100, 200, 500].find(size => half / size < 8) ?? 1000;
document.getElementById("square").textContent = square;

const colour = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const scaleOf = canvas => Math.min(canvas.width, canvas.height) / 2 / half;
const onGround = canvas => ([x, y]) => [
  canvas.width / 2 + (x - middle[0]) * scaleOf(canvas), canvas.height / 2 - (y - middle[1]) * scaleOf(canvas)];
const inSpace = canvas => ([x, y, z]) => {
  const [dx, dy, dz] = [x - middle[0], y - middle[1], z - middle[2]];
  const right = dx * Math.cos(turn) + dy * Math.sin(turn), far = dy * Math.cos(turn) - dx * Math.sin(turn);
  const scale = scaleOf(canvas) * zoom * 0.85;
  return [canvas.width / 2 + right * scale, canvas.height / 2 - (dz * Math.cos(lift) + far * Math.sin(lift)) * scale];
};

// a place in the level frame of a vehicle, in the world
const fromLevel = ([x, y, z, heading], [forward, left, up]) => {
  const [c, s] = [Math.cos(heading), Math.sin(heading)];
  return [x + c * forward - s * left, y + s * forward + c * left, z + up];
};

const path = (pen, points, close) => {
  pen.beginPath();
  points.forEach(([x, y], index) => index ? pen.lineTo(x, y) : pen.moveTo(x, y));
  if (close) pen.closePath();
};
const disc = (pen, [x, y], radius, fill) => {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  fill ? pen.fill() : pen.stroke();
};
const cross = (pen, [x, y], size) => {
  path(pen, [[x - size, y - size], [x + size, y + size]]); pen.stroke();
  path(pen, [[x - size, y + size], [x + size, y - size]]); pen.stroke();
};

const grid = (pen, place) => {
  pen.strokeStyle = colour("--rule");
  pen.lineWidth = 1;
  const count = Math.ceil(half / square) + 1;
  const [x0, y0] = [middle[0], middle[1]].map(value => Math.round(value / square) * square);
  const floor = reach[2][0] - 1;
  for (let k = -count; k <= count; k++) {
    path(pen, [[x0 + k * square, y0 - count * square, floor], [x0 + k * square, y0 + count * square, floor]].map(place)); pen.stroke();
    path(pen, [[x0 - count * square, y0 + k * square, floor], [x0 + count * square, y0 + k * square, floor]].map(place)); pen.stroke();
  }
};
const obstacles = (canvas, pen, place) => {
  const scale = scaleOf(canvas) * (canvas === space ? zoom * 0.85 : 1);
  pen.strokeStyle = colour("--faint");
  pen.lineCap = "round";
  pen.globalAlpha = 0.5;
  for (const { ends, radius } of film.obstacles) {
    pen.lineWidth = Math.max(2, 2 * radius * scale);
    const [a, b] = ends.map(place);
    path(pen, [a, [b[0] + 0.01, b[1]]]);
    pen.stroke();
  }
  pen.globalAlpha = 1;
};

const world = (canvas, place, shot, index) => {
  const pen = canvas.getContext("2d");
  pen.fillStyle = colour("--paper");
  pen.fillRect(0, 0, canvas.width, canvas.height);
  grid(pen, place);
  obstacles(canvas, pen, place);
  const chosen = Number(choice.value), scale = scaleOf(canvas) * (canvas === space ? zoom * 0.85 : 1);
  pen.lineWidth = 1;
  shot.p.forEach((now, vehicle) => {
    pen.strokeStyle = pen.fillStyle = vehicle === chosen ? colour("--cursor") : colour("--truth");
    pen.globalAlpha = 0.35;
    path(pen, film.shots.slice(Math.max(0, index - 40), index + 1).map(earlier => place(earlier.p[vehicle]))); pen.stroke();
    pen.globalAlpha = 1;
    const radius = Math.max(3, film.radii[vehicle] * scale);
    disc(pen, place(now), radius);
    path(pen, [now, fromLevel(now, [Math.max(film.radii[vehicle], 7 / scale), 0, 0])].map(place)); pen.stroke();
    if (canvas === space) { path(pen, [now, [now[0], now[1], reach[2][0] - 1]].map(place)); pen.globalAlpha = 0.15; pen.stroke(); pen.globalAlpha = 1; }
  });
  const own = shot.p[chosen];
  pen.lineWidth = 1.5;
  for (const [x, y, z, least, most, is] of shot.s[chosen] ?? []) {
    const length = Math.hypot(x, y, z) || 1, along = distance => fromLevel(own, [x, y, z].map(value => value / length * distance));
    pen.strokeStyle = pen.fillStyle = is < 0 ? colour("--warning") : colour("--estimate");
    pen.globalAlpha = 0.5;
    path(pen, [along(least), along(most < 0 ? 2 * half : most)].map(place)); pen.stroke();
    pen.globalAlpha = 1;
    is < 0 ? cross(pen, place(along(length)), 5) : disc(pen, place(along(length)), 3, true);
  }
};

// A text beside a ring: at the first side on which it covers nothing and is not cut.
const beside = (pen, text, [u, v, radius], height, taken) => {
  const width = pen.measureText(text).width, gap = radius + 0.4 * height;
  const sides = [[u + gap, v - height / 2], [u - gap - width, v - height / 2], [u - width / 2, v - gap - height], [u - width / 2, v + gap]];
  const isFree = ([x, y]) => x >= 0 && x + width <= view.width && y >= 0 && y + height <= view.height
    && taken.every(([left, top, right, bottom]) => x > right || x + width < left || y > bottom || y + height < top);
  const [x, y] = sides.find(isFree) ?? [Math.min(u + gap, view.width - width), v - height / 2];
  taken.push([x, y, x + width, y + height]);
  pen.fillText(text, x, y + 0.8 * height);
};

const around = (shot) => {
  const pen = view.getContext("2d"), chosen = Number(choice.value), own = shot.p[chosen];
  pen.fillStyle = colour("--paper");
  pen.fillRect(0, 0, view.width, view.height);
  pen.strokeStyle = colour("--rule");
  path(pen, [[0, view.height / 2], [view.width, view.height / 2]]); pen.stroke();
  const at = ([forward, left, up]) => {
    const far = Math.hypot(forward, left, up) || 1;
    const azimuth = Math.atan2(left, forward), elevation = Math.asin(up / far);
    return [view.width / 2 - azimuth / Math.PI * view.width / 2, view.height / 2 - elevation / Math.PI * view.width / 2, far];
  };
  pen.lineWidth = 1.5;
  // As large on a narrow screen, where the picture shrinks, as on a wide one.
  const size = Math.max(15, 12 * view.width / (view.clientWidth || view.width));
  pen.font = size + "px system-ui, sans-serif";
  const ring = (vehicle, far) => Math.min(60, Math.max(3, film.radii[vehicle] / far / Math.PI * view.width / 2));
  const taken = [];
  shot.p.forEach(([x, y, z], vehicle) => {
    if (vehicle === chosen) return;
    const [dx, dy, dz] = [x - own[0], y - own[1], z - own[2]], c = Math.cos(own[3]), s = Math.sin(own[3]);
    const [u, v, far] = at([c * dx + s * dy, c * dy - s * dx, dz]);
    const radius = ring(vehicle, far);
    pen.strokeStyle = colour("--truth");
    disc(pen, [u, v], radius);
    taken.push([u - radius, v - radius, u + radius, v + radius]);
  });
  for (const [x, y, z, , , is] of shot.s[chosen] ?? []) {
    const [u, v, far] = at([x, y, z]);
    pen.strokeStyle = pen.fillStyle = is < 0 ? colour("--warning") : colour("--estimate");
    is < 0 ? cross(pen, [u, v], 6) : disc(pen, [u, v], 4, true);
    beside(pen, far.toFixed(1) + " m", [u, v, is < 0 ? 6 : ring(is, far)], size, taken);
  }
  if (!shot.s[chosen]) {
    pen.fillStyle = colour("--faint");
    pen.fillText("What this vehicle saw is in its file under vehicles/; the page holds that of the first " + film.viewers + ".", 20, 30);
  }
};

const show = () => {
  const index = Number(slider.value), shot = film.shots[index];
  clock.textContent = shot.t.toFixed(1) + " s";
  world(above, onGround(above), shot, index);
  world(space, inSpace(space), shot, index);
  around(shot);
};
const pause = paused => { playing = !paused; button.textContent = paused ? "Play" : "Pause"; };
slider.oninput = () => { pause(true); show(); };
button.onclick = () => pause(playing);
choice.onchange = show;
above.onclick = event => {
  const box = above.getBoundingClientRect(), place = onGround(above), shot = film.shots[Number(slider.value)];
  const [x, y] = [(event.clientX - box.left) / box.width * above.width, (event.clientY - box.top) / box.height * above.height];
  const off = shot.p.map(now => { const [u, v] = place(now); return Math.hypot(u - x, v - y); });
  choice.value = off.indexOf(Math.min(...off));
  show();
};
space.onpointermove = event => {
  if (!event.buttons) return;
  turn += event.movementX * 0.01;
  lift = Math.min(1.5, Math.max(0, lift + event.movementY * 0.01));
  show();
};
space.onwheel = event => { event.preventDefault(); zoom *= Math.exp(-event.deltaY * 0.001); show(); };
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);
setInterval(() => {
  if (!playing) return;
  slider.value = (Number(slider.value) + 1) % film.shots.length;
  show();
}, 100);
show();
