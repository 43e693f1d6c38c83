// Runs the core as WebAssembly that may ask for nothing, and holds the hash of what it told against the one that is written down.
import { readFileSync } from "node:fs";

const module = new WebAssembly.Module(readFileSync(process.argv[2]));
const imports = WebAssembly.Module.imports(module);
if (imports.length > 0) {
  console.error(`the core asks for ${imports.map(({ module, name }) => `${module}.${name}`).join(", ")}`);
  process.exit(1);
}
const { photinus_told, photinus_pinned } = new WebAssembly.Instance(module).exports;
const hex = (number) => `0x${BigInt.asUintN(64, number).toString(16).padStart(16, "0")}`;
const [told, pinned] = [photinus_told(), photinus_pinned()].map(hex);
console.log(`without an operating system: ${told}, written down: ${pinned}`);
process.exit(told === pinned ? 0 : 1);
