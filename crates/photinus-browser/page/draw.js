// What was located, drawn and said in a table. A flight adds where the robots truly are.

const MARKS = ["#56b4e9", "#e69f00", "#2fc49b", "#f07b3f", "#d98cb3", "#f0e442"];
const BRIGHTER = 4;

/// Neighbours are called by their tracks where they are followed, else by their place in the frame.
const called = ({ track }, index) => track?.id ?? index + 1;
const marked = (neighbour, index) => MARKS[called(neighbour, index) % MARKS.length];
const estimated = ({ distance_m }) => distance_m.estimate !== null;

function drawPicture({ width, height, grey }, { spots = [], neighbours = [] } = {}) {
  const canvas = at("picture");
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  const drawn = new Uint32Array(image.data.buffer); // 0xAABBGGRR
  grey.forEach((level, i) => (drawn[i] = 0xff000000 | (Math.min(255, BRIGHTER * level) * 0x010101)));
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
    const colour = marked(neighbour, index);
    const members = neighbour.spots.map((spot) => spots[spot]).sort((a, b) => a.u_px - b.u_px);
    members.forEach((spot) => circle(spot, colour));
    context.beginPath();
    members.forEach((spot) => context.lineTo(spot.u_px, spot.v_px));
    context.stroke();
    const name = called(neighbour, index);
    const label = estimated(neighbour) ? `${name}: ${neighbour.distance_m.estimate.toFixed(1)} m` : `${name}`;
    const u = Math.min(members[0].u_px, width - 130 * scale);
    const above = Math.min(...members.map((spot) => spot.v_px)) - 18 * scale;
    context.fillStyle = colour;
    context.fillText(label, u, above > 20 * scale ? above : above + 60 * scale);
  });
}

/// The view from above: metres per canvas, and where a place of the camera frame is drawn. A flight keeps its scale.
function seenFromAbove(farthest) {
  const { width, height } = at("above");
  const scale = (height - 40) / farthest;
  return { farthest, scale, middle: width / 2, bottom: height - 20, place: (x, z) => [width / 2 + x * scale, height - 20 - z * scale] };
}

function farthestOf(neighbours) {
  const reach = ({ distance_m: d }) => 1.15 * Math.min(d.max ?? d.estimate, 1.6 * d.estimate) || 0;
  return Math.max(10, ...neighbours.map(reach));
}

function drawAbove({ neighbours }, view) {
  const context = at("above").getContext("2d");
  context.clearRect(0, 0, at("above").width, at("above").height);
  const { farthest, scale, middle, bottom } = view;
  const place = (bearing, distance) => {
    const level = Math.hypot(bearing[0], bearing[2]) || 1;
    return view.place((bearing[0] / level) * distance, (bearing[2] / level) * distance);
  };
  context.font = "18px system-ui, sans-serif";
  context.lineWidth = 1;
  const step = farthest > 24 ? 10 : farthest > 12 ? 5 : 2;
  for (let ring = step; ring <= farthest; ring += step) {
    context.strokeStyle = "#39424a";
    context.beginPath();
    context.arc(middle, bottom, ring * scale, Math.PI, 2 * Math.PI);
    context.stroke();
    context.fillStyle = "#8b959d";
    context.fillText(`${ring} m`, middle + 4, bottom - 4 - ring * scale);
  }
  const segment = (bearing, from, to, thick, colour) => {
    context.strokeStyle = colour;
    context.lineWidth = thick;
    context.beginPath();
    context.moveTo(...place(bearing, from));
    context.lineTo(...place(bearing, to));
    context.stroke();
  };
  neighbours.forEach((neighbour, index) => {
    const { bearing, distance_m: d } = neighbour;
    const colour = marked(neighbour, index);
    if (d.max !== null) segment(bearing, d.min, Math.min(d.max, 2 * farthest), 10, `${colour}55`);
    if (!estimated(neighbour)) return;
    segment(bearing, Math.max(0, d.estimate - 2 * d.sigma), d.estimate + 2 * d.sigma, 3, colour);
    const [x, y] = place(bearing, d.estimate);
    context.fillStyle = colour;
    context.beginPath();
    context.arc(x, y, 7, 0, 2 * Math.PI);
    context.fill();
    context.fillText(`${called(neighbour, index)}`, x + 12, y + 6);
  });
  context.fillStyle = "#e4e7ea";
  context.beginPath();
  context.arc(middle, bottom, 5, 0, 2 * Math.PI);
  context.fill();
}

/// Rings where robots truly are, a stroke to their heading, and crosses where they are wanted.
function drawRobots(robots, goals, radius_m, view) {
  const context = at("above").getContext("2d");
  context.strokeStyle = context.fillStyle = "#e4e7ea";
  context.lineWidth = 1.5;
  robots.forEach(({ position_m: [x, , z], heading_rad }, index) => {
    const [u, v] = view.place(x, z);
    const ring = Math.max(12, radius_m * view.scale);
    context.beginPath();
    context.arc(u, v, ring, 0, 2 * Math.PI);
    context.moveTo(u, v);
    context.lineTo(u - 1.4 * ring * Math.sin(heading_rad), v - 1.4 * ring * Math.cos(heading_rad));
    context.stroke();
    context.fillText("AB"[index], u - ring - 18, v + 6);
    const [gu, gv] = view.place(goals[index].x, goals[index].z);
    context.beginPath();
    for (const [du, dv] of [[6, 6], [6, -6]]) {
      context.moveTo(gu - du, gv - dv);
      context.lineTo(gu + du, gv + dv);
    }
    context.stroke();
  });
}

const fixed = (number, digits = 2) => (number === undefined || number === null ? "-" : number.toFixed(digits));

/// Lines of a table in place of those that are there.
function fill(body, lines) {
  const line = (values) => {
    const element = document.createElement("tr");
    element.append(...values.map((value) => Object.assign(document.createElement("td"), { textContent: value })));
    return element;
  };
  body.replaceChildren(...lines.map(line));
}

/// The robot nearest to the direction in which a neighbour is seen.
function nearest({ bearing }, robots) {
  const along = ({ position_m: p, distance_m }) => (bearing[0] * p[0] + bearing[1] * p[1] + bearing[2] * p[2]) / distance_m;
  return robots.reduce((best, robot) => (along(robot) > along(best) ? robot : best));
}

/// The table, and a sentence that begins with the name of the picture.
function tell(name, { spots, rejected, neighbours, took_ms }, robots = null) {
  const side = (rad, one, other) => `${fixed((180 / Math.PI) * Math.abs(rad), 1)} ${rad < 0 ? other : one}`;
  const row = (neighbour, index) => {
    const { bearing, distance_m: d, probability, spots: members, track } = neighbour;
    return [
      called(neighbour, index),
      fixed(d.estimate),
      fixed(d.sigma),
      `${fixed(d.min)} to ${fixed(d.max)}`,
      `${side(Math.atan2(bearing[0], bearing[2]), "right", "left")}, ${side(-Math.asin(bearing[1]), "up", "down")}`,
      `${fixed(100 * probability, 1)} %`,
      fixed(track && Math.hypot(...track.velocity_m_s), 1),
      ...(robots ? [fixed(nearest(neighbour, robots).distance_m)] : []),
      members.length,
    ];
  };
  fill(at("rows"), neighbours.map(row));
  const count = (number, word) => `${number} ${word}${number === 1 ? "" : "s"}`;
  at("said").textContent =
    `${name}: ${count(spots.length, "spot")}, ${count(rejected, "bright region")} rejected, ` +
    `${count(neighbours.length, "neighbour")}, in ${took_ms.toFixed(1)} ms.`;
}

/// Says what is wrong; nothing is located.
function complain(reason) {
  at("said").textContent = reason;
  fill(at("rows"), []);
}
