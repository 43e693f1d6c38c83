// Pictures in, from the recording or from a person.

const RATE_HZ = 6;
let picture = null; // { width, height, grey, name, time_s }
let playing = null;

/// A picture's light, each pixel the mean of its colours.
async function decode(source, name, time_s = NaN) {
  const bitmap = await createImageBitmap(source);
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
  const grey = new Uint8Array(bitmap.width * bitmap.height);
  for (let i = 0; i < grey.length; i++) grey[i] = Math.round((data[4 * i] + data[4 * i + 1] + data[4 * i + 2]) / 3);
  return { width: bitmap.width, height: bitmap.height, grey, name, time_s };
}

function show() {
  if (!picture) return;
  if (!isSetUp(picture)) {
    drawPicture(picture);
    return complain(NO_SET_UP);
  }
  pixels(picture.grey.length).set(picture.grey);
  const told = locate(picture.time_s);
  drawPicture(picture, told);
  drawAbove(told, seenFromAbove(farthestOf(told.neighbours)));
  tell(picture.name, told);
}

async function open(source, name) {
  stop();
  try {
    picture = await decode(source, name);
    at("shown").textContent = "";
    show();
  } catch (error) {
    complain(`${name} is no picture that this browser reads (${error.message}).`);
  }
}

const frames = [];
async function seek(number) {
  at("time").value = number;
  const name = `frame ${number + 1} of ${FRAMES.length}`;
  frames[number] ??= await decode(new Blob([bytes(FRAMES[number])], { type: "image/png" }), name, number / RATE_HZ);
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
  playing = setInterval(() => seek((Number(at("time").value) + 1) % FRAMES.length), 1000 / RATE_HZ);
};
at("time").max = FRAMES.length - 1;
at("time").oninput = () => {
  stop();
  seek(Number(at("time").value));
};
at("file").onchange = ({ target }) => target.files[0] && open(target.files[0], target.files[0].name);

const drop = at("drop");
["dragenter", "dragover"].forEach((kind) =>
  addEventListener(kind, (event) => (event.preventDefault(), drop.classList.add("over"))),
);
addEventListener("dragleave", () => drop.classList.remove("over"));
addEventListener("drop", (event) => {
  event.preventDefault();
  drop.classList.remove("over");
  const [file] = event.dataTransfer.files;
  if (!file) return;
  choose("pictures");
  open(file, file.name);
});
