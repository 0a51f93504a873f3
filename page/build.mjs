// Builds the page into one file, src/auricle/viewer/static/page.html, that needs nothing beside it.
//
// The file names the SHA-256 of its sources, so that a machine without Node can tell whether it is
// current: of every file below page/ but node_modules, in the order of their paths, the path, a
// line feed, the file's length in bytes, a line feed and its bytes.
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, readdirSync, statSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "vite";

const here = dirname(fileURLToPath(import.meta.url));
const target = join(here, "..", "src", "auricle", "viewer", "static", "page.html");

function files(folder, prefix = "") {
  return readdirSync(folder)
    .filter((name) => name !== "node_modules" && !name.startsWith("."))
    .flatMap((name) => {
      const path = join(folder, name);
      return statSync(path).isDirectory()
        ? files(path, `${prefix}${name}/`)
        : [{ name: `${prefix}${name}`, path }];
    });
}

function digest() {
  const hash = createHash("sha256");
  const all = files(here).sort((one, other) => (one.name < other.name ? -1 : 1));
  for (const { name, path } of all) {
    const bytes = readFileSync(path);
    hash.update(`${name}\n${bytes.length}\n`).update(bytes);
  }
  return hash.digest("hex");
}

const result = await build({
  root: here,
  configFile: false,
  logLevel: "warn",
  build: {
    write: false,
    target: "es2022",
    cssCodeSplit: false,
    modulePreload: false,
    rollupOptions: { input: join(here, "src", "main.ts") },
  },
});
const output = (Array.isArray(result) ? result[0] : result).output;
const script = output.filter((each) => each.type === "chunk").map((each) => each.code).join("\n");
const style = output.filter((each) => each.fileName.endsWith(".css")).map((each) => each.source).join("\n");
const parts = {
  SOURCES: digest(),
  STYLE: style.trim(),
  SCRIPT: script.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--").trim(),
};
const page = readFileSync(join(here, "index.html"), "utf8").replace(
  /%(SOURCES|STYLE|SCRIPT)%/g,
  (_, name) => parts[name],
);
mkdirSync(dirname(target), { recursive: true });
writeFileSync(target, page);
console.log(`page.html: ${(page.length / 1000).toFixed(0)} kB`);
