const player = document.querySelector(".player");
const shots = JSON.parse(player.querySelector("script[type='application/json']").textContent);
const images = shots.map(shot => { const image = new Image(); image.src = shot.file; return image; });
const picture = player.querySelector(".picture img");
const place = player.querySelector("input");
const button = player.querySelector("button");
const clock = player.querySelector("output");
const timelines = [...player.querySelectorAll(".timeline")];
let playing = true;
place.max = shots.length - 1;
const show = () => {
  const shot = shots[place.value];
  picture.src = images[place.value].src;
  clock.textContent = shot.time_s.toFixed(1) + " s";
  for (const timeline of timelines) {
    const { left, right, from, to } = timeline.dataset;
    const x = Number(left) + (Number(right) - Number(left)) * (shot.time_s - from) / Math.max(to - from, 1e-9);
    const cursor = timeline.querySelector(".cursor");
    cursor.setAttribute("x1", x);
    cursor.setAttribute("x2", x);
  }
};
const pause = paused => { playing = !paused; button.textContent = paused ? "Play" : "Pause"; };
place.oninput = () => { pause(true); show(); };
button.onclick = () => pause(playing);
for (const timeline of timelines) {
  timeline.onclick = event => {
    const box = timeline.getBoundingClientRect();
    const { left, right, from, to } = timeline.dataset;
    const x = (event.clientX - box.left) / box.width * timeline.viewBox.baseVal.width;
    const time_s = Number(from) + (x - left) / (right - left) * (to - from);
    const off = shots.map(shot => Math.abs(shot.time_s - time_s));
    place.value = off.indexOf(Math.min(...off));
    pause(true);
    show();
  };
}
setInterval(() => {
  const next = (Number(place.value) + 1) % shots.length;
  // Waits for what is still being loaded.
  if (playing && images[next].complete) { place.value = next; show(); }
}, 200);
show();
