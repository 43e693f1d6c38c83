// What the page says, as a browser shows it, against the simulator's truth and against the program: check.mjs PAGE.html RECORDING PROGRAM.
// Pictures of the page are left beside it.
import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { pathToFileURL } from "node:url";

/// The page has so long for each thing that it is asked for.
const LIMIT_MS = 60_000;
const FRAMES = [3, 10, 20, 28];
const DESK = { width: 1300, height: 1150 };
const PHONE = { width: 400, height: 860 };
const [pageFile, recording, program] = process.argv.slice(2);
const beside = (name) => join(dirname(pageFile), name);

/// Chromium and how to ask it through its pipe: JSON that ends with a zero, https://chromedevtools.github.io/devtools-protocol.
function open() {
  const browser = spawn("chromium", ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe"], {
    stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"],
  });
  const [, , , questions, answers] = browser.stdio;
  // That it has ended says its exit.
  for (const pipe of [questions, answers]) pipe.on("error", () => {});
  const waiting = new Map();
  let unread = "";
  answers.setEncoding("utf8").on("data", (text) => {
    const messages = (unread + text).split("\0");
    unread = messages.pop();
    for (const { id, ...said } of messages.map((message) => JSON.parse(message))) {
      waiting.get(id)?.(said);
      waiting.delete(id);
    }
  });
  let asked = 0;
  const ask = async (method, params = {}, sessionId = undefined) => {
    const id = ++asked;
    questions.write(JSON.stringify({ id, method, params, sessionId }) + "\0");
    const { result, error } = await new Promise((answer) => waiting.set(id, answer));
    if (error) throw new Error(`${method}: ${error.message}`);
    return result;
  };
  return { browser, ask };
}

/// The page in a tab of its own.
class Tab {
  static async open(ask, hash, { width, height } = DESK) {
    const tab = new Tab();
    const { targetId } = await ask("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await ask("Target.attachToTarget", { targetId, flatten: true });
    tab.ask = (method, params) => ask(method, params, sessionId);
    tab.close = () => ask("Target.closeTarget", { targetId });
    await tab.ask("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: width < 700 });
    await tab.ask("Page.navigate", { url: `${pathToFileURL(pageFile)}#${hash}` });
    return tab;
  }

  async evaluate(expression) {
    const { result, exceptionDetails } = await this.ask("Runtime.evaluate", { expression, awaitPromise: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  /// What an element says once that is matched. The page decodes and plans beside its own thread: that it has loaded says nothing.
  async said(id, pattern) {
    const said = await this.evaluate(`new Promise((spoken) => {
      const begun = performance.now();
      const look = () => {
        const said = document.getElementById("${id}")?.textContent ?? "";
        if (${pattern}.test(said) || performance.now() > begun + ${LIMIT_MS}) spoken(said);
        else setTimeout(look, 20);
      };
      look();
    })`);
    if (!pattern.test(said)) throw new Error(`#${id} says "${said}" and never ${pattern}`);
    return said;
  }

  /// The lines of a table.
  async rows(id) {
    const cells = `[...document.querySelectorAll("#${id} tr")].map((row) => [...row.cells].map((cell) => cell.textContent))`;
    return JSON.parse(await this.evaluate(`JSON.stringify(${cells})`));
  }

  /// Presses at one place of an element, moves to another, lets go; shares of its width and height.
  async drag(id, from, to) {
    const box = JSON.parse(await this.evaluate(`JSON.stringify(document.getElementById("${id}").getBoundingClientRect())`));
    const at = ([u, v]) => ({ x: box.x + u * box.width, y: box.y + v * box.height, button: "left", clickCount: 1 });
    await this.ask("Input.dispatchMouseEvent", { type: "mousePressed", ...at(from) });
    await this.ask("Input.dispatchMouseEvent", { type: "mouseMoved", ...at(to) });
    await this.ask("Input.dispatchMouseEvent", { type: "mouseReleased", ...at(to) });
  }

  async picture(name) {
    const { data } = await this.ask("Page.captureScreenshot");
    writeFileSync(beside(name), Buffer.from(data, "base64"));
  }
}

function hold(condition, reason, rows = []) {
  if (!condition) throw new Error([reason, ...rows.map((row) => row.join(" | "))].join("\n"));
}

/// Whether a line of the table is right about a distance.
function holdRow(row, truth_m, what) {
  const [estimate, sigma] = [Number(row[1]), Number(row[2])];
  const [least, most] = row[3].split(" to ").map(Number);
  hold(Math.abs(estimate - truth_m) < 4 * sigma + 0.01, `${what}: ${truth_m.toFixed(2)} m is farther than 4 sigma from the estimate`, [row]);
  hold(least - 0.01 <= truth_m && truth_m <= most + 0.01, `${what}: ${truth_m.toFixed(2)} m is not within the bounds`, [row]);
}

/// A frame of the recording: everybody who was there, nobody else, at the right distance.
async function pictures(ask, frame) {
  const there = JSON.parse(readFileSync(join(recording, "truth.jsonl"), "utf8").split("\n")[frame - 1]).neighbours;
  const tab = await Tab.open(ask, frame);
  const said = await tab.said("said", new RegExp(`^frame ${frame} of `));
  const rows = await tab.rows("rows");
  hold(rows.length === there.length, `frame ${frame}: ${there.length} neighbours are there`, rows);
  const azimuth = ([, , , , bearing]) => Number.parseFloat(bearing) * (bearing.includes("left") ? -1 : 1);
  for (const { distance_m, position_m: [x, , z] } of there) {
    const deg = (180 / Math.PI) * Math.atan2(x, z);
    const row = rows.find((row) => Math.abs(azimuth(row) - deg) < 2);
    hold(row, `frame ${frame}: nobody is at ${deg.toFixed(1)} deg`, rows);
    holdRow(row, distance_m, `frame ${frame}`);
  }
  await tab.close();
  return said;
}

/// A flight: both robots are located, and one of them goes where it is dragged.
async function flight(ask) {
  const tab = await Tab.open(ask, "fly");
  await tab.said("said", /^1\.\d s in flight/);
  const truths = async () => (await tab.rows("rows")).map((row) => Number(row[7])).sort((a, b) => a - b);
  const [, farther_m] = await truths();
  // B stands 2 m to the right, 7 m ahead: it is dragged to 12 m, from above
  await tab.drag("above", [0.5 + (2 * 27.5) / 600, 1 - (20 + 7 * 27.5) / 480], [0.6, 1 - (20 + 12 * 27.5) / 480]);
  const said = await tab.said("said", /^[6-9]\.\d s in flight.* 2 neighbours/);
  await tab.evaluate(`document.getElementById("pause").click()`);
  const rows = await tab.rows("rows");
  hold(rows.length === 2, "two robots fly", rows);
  for (const row of rows) holdRow(row, Number(row[7]), "flight");
  const [, now_m] = await truths();
  hold(Math.abs(farther_m - 7.29) < 0.1 && Math.abs(now_m - 12.24) < 0.3, `a robot dragged to 12 m is at ${now_m} m`, rows);
  await tab.picture("fly.png");
  await tab.close();
  return said;
}

/// A plan: what the program says of the same file.
async function plan(ask) {
  const tab = await Tab.open(ask, "plan");
  const said = await tab.said("planned", /^Worked out/);
  writeFileSync(beside("set-up.toml"), await tab.evaluate(`document.getElementById("file-of-plan").value`));
  const { distance, layouts, battery } = JSON.parse(execFileSync(program, ["plan", beside("set-up.toml"), "--json"], { encoding: "utf8" }));
  const reach = await tab.evaluate(`document.getElementById("reach").textContent`);
  const told = `A distance (two spots)in 95 of 100 frames to ${distance.nearly_all_m.toFixed(1)} m, in half of them to ${distance.half_m.toFixed(1)} m`;
  hold(reach.includes(told), `the program says "${told}", the page "${reach}"`);
  const rows = await tab.rows("layouts");
  const same = ([name, two, error, half], layout) =>
    name === layout.name && two === (100 * layout.two).toFixed(0) && error === layout.distance_error_m.toFixed(3) && half === layout.half_m.toFixed(1);
  hold(rows.length === layouts.length && rows.every((row, index) => same(row, layouts[index])), "layouts are not the program's", rows);
  const light = await tab.evaluate(`document.getElementById("battery").textContent`);
  hold(light.startsWith(`Light takes ${battery.light_w.toFixed(1)} W`), `the program has ${battery.light_w} W of light, the page "${light}"`);
  await tab.picture("plan.png");
  const wrong = `Object.assign(document.getElementById("file-of-plan"), { value: "exposure_us = -1" }), document.getElementById("ask").click()`;
  await tab.evaluate(wrong);
  await tab.said("planned", /missing key `led`/);
  await tab.close();
  return `Plan: ${said}`;
}

/// Nothing is wider than the screen of a phone.
async function phone(ask) {
  for (const [hash, id, pattern] of [["5", "said", /^frame 5/], ["fly", "said", /s in flight/], ["plan", "planned", /^Worked out/]]) {
    const tab = await Tab.open(ask, hash, PHONE);
    await tab.said(id, pattern);
    const width = await tab.evaluate("document.documentElement.scrollWidth");
    await tab.picture(`phone-${hash}.png`);
    hold(width <= PHONE.width, `#${hash} is ${width} px wide on a phone of ${PHONE.width}`);
    await tab.close();
  }
  return "On a phone nothing is wider than the screen.";
}

const { browser, ask } = open();
const gone = once(browser, "exit").then(([code]) => {
  throw new Error(`chromium ended with ${code} before it had answered`);
});
const look = async () => {
  for (const frame of FRAMES) console.log(await pictures(ask, frame));
  for (const part of [flight, plan, phone]) console.log(await part(ask));
};
const stuck = new Promise((_, refuse) => {
  setTimeout(() => refuse(new Error("chromium does not answer")), 10 * LIMIT_MS).unref();
});
try {
  await Promise.race([look(), gone, stuck]);
} catch (error) {
  console.error(error.message);
  process.exitCode = 1;
} finally {
  gone.catch(() => {});
  browser.kill();
}
