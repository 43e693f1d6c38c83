// Two robots that fly where they are dragged, and what the camera sees of them.

const SCALE_M = 16;
const NEAREST_M = 0.7;
const goals = [{}, {}]; // { x, y, z, heading_rad }, camera frame
let robots = [];
let flying = null; // the request for the next frame
let last = 0; // when the last one was asked for, ms

/// The camera's size by its kind in the form.
function sizeOf() {
  const { width, height } = form.elements.camera.selectedOptions[0].dataset;
  return { width: Number(width), height: Number(height) };
}

/// Begins anew with what the form says; false where there is no such set-up.
function takeOff() {
  const isReady = isSetUp(sizeOf(), true) && core.photinus_fly(number("exposure"), number("sky"));
  if (!isReady) {
    complain(NO_SET_UP);
    return false;
  }
  ({ robots } = JSON.parse(text(core.photinus_step(0))));
  robots.forEach(({ position_m: [x, y, z], heading_rad }, index) => {
    if (goals[index].x === undefined) goals[index] = { x, y, z, heading_rad };
    steer(index, {});
  });
  return true;
}

function steer(index, goal) {
  Object.assign(goals[index], goal);
  const { x, y, z, heading_rad } = goals[index];
  core.photinus_steer(index, x, y, z, heading_rad);
}

function step(now_ms) {
  const step_s = Math.min(0.1, Math.max(0.001, (now_ms - last) / 1000));
  last = now_ms;
  const begun = performance.now();
  const flight = JSON.parse(text(core.photinus_step(step_s)));
  const rendered_ms = performance.now() - begun;
  const { time_s } = flight;
  robots = flight.robots;
  const told = locate(time_s);
  const size = sizeOf();
  drawPicture({ ...size, grey: pixels(size.width * size.height) }, told);
  const view = seenFromAbove(SCALE_M);
  drawAbove(told, view);
  drawRobots(robots, goals, number("radius"), view);
  tell(`${time_s.toFixed(1)} s in flight, rendered in ${rendered_ms.toFixed(0)} ms`, told, robots);
}

function keepFlying(now_ms) {
  step(now_ms);
  flying = requestAnimationFrame(keepFlying);
}

function flyOn() {
  at("pause").textContent = "Pause";
  last = performance.now();
  flying = requestAnimationFrame(keepFlying);
}

function fly() {
  land();
  if (takeOff()) flyOn();
}

function land() {
  cancelAnimationFrame(flying);
  flying = null;
  at("pause").textContent = "Fly on";
}

at("pause").onclick = () => (flying === null ? flyOn() : land());

const chosen = () => Number(at("robot").value);
function chooseRobot(index) {
  at("robot").value = index;
  at("heading").value = (180 / Math.PI) * goals[index].heading_rad;
}
at("robot").onchange = () => chooseRobot(chosen());
at("heading").oninput = () => steer(chosen(), { heading_rad: (Math.PI / 180) * at("heading").value });

/// Where on a canvas a pointer is, in its own pixels.
function placeOn(canvas, { clientX, clientY }) {
  const box = canvas.getBoundingClientRect();
  return [((clientX - box.left) / box.width) * canvas.width, ((clientY - box.top) / box.height) * canvas.height];
}

/// Where a robot is in the picture, by the lens: equidistant.
function inPicture([x, y, z]) {
  const { width, height } = sizeOf();
  const across = Math.hypot(x, y) || 1e-9;
  const radius_px = number("focal") * Math.atan2(across, z);
  return [(width - 1) / 2 + (radius_px * x) / across, (height - 1) / 2 + (radius_px * y) / across];
}

/// The direction of a pixel: a unit vector.
function direction([u, v]) {
  const { width, height } = sizeOf();
  const [x, y] = [u - (width - 1) / 2, v - (height - 1) / 2];
  const radius_px = Math.hypot(x, y) || 1e-9;
  const angle = radius_px / number("focal");
  return [(Math.sin(angle) * x) / radius_px, (Math.sin(angle) * y) / radius_px, Math.cos(angle)];
}

/// Where a robot is wanted that is dragged: from above it keeps its height, in the picture its distance.
const draggedAbove = ([u, v]) => {
  const { scale, middle, bottom } = seenFromAbove(SCALE_M);
  const [x, z] = [(u - middle) / scale, Math.max(0.3, (bottom - v) / scale)];
  const short = NEAREST_M / Math.hypot(x, z);
  return short > 1 ? { x: x * short, z: z * short } : { x, z };
};
const draggedInPicture = (place, { x, y, z }) => {
  const distance = Math.max(NEAREST_M, Math.hypot(x, y, z));
  const [dx, dy, dz] = direction(place);
  return { x: distance * dx, y: distance * dy, z: distance * Math.max(0.1, dz) };
};

/// Robots are dragged on a canvas: `placed` says where one is drawn, `dragged` where it is wanted when its goal is dragged to a place.
function draggable(canvas, placed, dragged) {
  let held = null;
  canvas.addEventListener("pointerdown", (event) => {
    if (!document.body.classList.contains("flying") || !robots.length) return;
    const [u, v] = placeOn(canvas, event);
    const far = ({ position_m }) => Math.hypot(placed(position_m)[0] - u, placed(position_m)[1] - v);
    held = far(robots[0]) <= far(robots[1]) ? 0 : 1;
    chooseRobot(held);
    canvas.setPointerCapture(event.pointerId);
    steer(held, dragged([u, v], goals[held]));
  });
  canvas.addEventListener("pointermove", (event) => held !== null && steer(held, dragged(placeOn(canvas, event), goals[held])));
  ["pointerup", "pointercancel"].forEach((kind) => canvas.addEventListener(kind, () => (held = null)));
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!document.body.classList.contains("flying")) return;
      event.preventDefault();
      const turned = goals[chosen()].heading_rad - 0.2 * Math.sign(event.deltaY);
      steer(chosen(), { heading_rad: Math.atan2(Math.sin(turned), Math.cos(turned)) });
      chooseRobot(chosen());
    },
    { passive: false },
  );
}
draggable(at("above"), ([x, , z]) => seenFromAbove(SCALE_M).place(x, z), draggedAbove);
draggable(at("picture"), inPicture, draggedInPicture);
