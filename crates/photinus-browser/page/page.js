// The three things that the page does, one at a time, and the set-up that two of them share.

const TABS = ["pictures", "fly", "plan"];

function choose(tab, frame = 0) {
  for (const each of TABS) at(`tab-${each}`).setAttribute("aria-selected", each === tab);
  document.body.classList.toggle("flying", tab === "fly");
  at("seeing").hidden = tab === "plan";
  at("planning").hidden = tab !== "plan";
  stop();
  land();
  if (tab === "pictures") picture ? show() : seek(frame);
  if (tab === "fly") fly();
  if (tab === "plan" && at("plan").hidden) plan();
}
for (const each of TABS) at(`tab-${each}`).onclick = () => choose(each);

form.elements.camera.onchange = ({ target }) => {
  if (target.value !== "other") form.elements.focal.value = target.value;
};
form.elements.airframe.onchange = ({ target }) => {
  if (target.value === "other") return;
  const [arms, radius, leds, splay] = target.value.split(",");
  Object.entries({ arms, radius, leds, splay }).forEach(([name, value]) => (form.elements[name].value = value));
};
form.onchange = () => (document.body.classList.contains("flying") ? fly() : show());
form.onsubmit = (event) => event.preventDefault();

// A link may say what is shown first: index.html#12 a frame, index.html#fly, index.html#plan
const asked = location.hash.slice(1);
if (asked === "fly" || asked === "plan") choose(asked);
else choose("pictures", Math.min(Math.max(Number(asked) || 1, 1), FRAMES.length) - 1);
