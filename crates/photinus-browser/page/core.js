// The core as WebAssembly, and what it tells. WASM (packed by gzip) and FRAMES stand above, as base64.

const at = (id) => document.getElementById(id);
const bytes = (base64) => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));

/// The bytes of the module.
async function unpacked() {
  const packed = new Blob([bytes(WASM)]).stream();
  return new Response(packed.pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

const MODULE = await unpacked();
const core = (await WebAssembly.instantiate(MODULE)).instance.exports;

/// The text of which the core told so many bytes.
const text = (length) => new TextDecoder().decode(new Uint8Array(core.memory.buffer, core.photinus_told(), length));
/// The picture before the locator; after a call that takes memory it has to be asked for anew.
const pixels = (length) => new Uint8Array(core.memory.buffer, core.photinus_pixels(), length);

const form = at("setup");
const number = (name) => Number(form.elements[name].value);
let setUp = "";

/// Camera and ring as the form says, for a picture of this size. The core begins anew where they are not those of before; false where there
/// are none such.
function isSetUp({ width, height }, anew = false) {
  const asked = [width, height, number("focal"), number("arms"), number("radius"), number("leds"), number("splay")];
  if (anew || String(asked) !== setUp) setUp = core.photinus_set_up(...asked) ? String(asked) : "";
  return setUp !== "";
}

/// What the core tells of the picture before it, and how long it took; with a time, s, neighbours are followed.
function locate(time_s = NaN) {
  const begun = performance.now();
  const length = core.photinus_locate(form.elements.level.checked ? 1 : 0, time_s);
  const took_ms = performance.now() - begun;
  return { ...JSON.parse(text(length)), took_ms };
}

const NO_SET_UP = "There is no such camera or no such ring of LEDs: correct the numbers below.";
