/** What is dropped on the page: files and whole folders, sent to the server in one piece. */

export interface Dropped {
  /** Below what was dropped: "export/study.xml", or a name alone. */
  readonly path: string;
  readonly file: File;
}

/** Everything in a drop. Folders are read to the bottom; what is hidden in them is left out. */
export async function droppedFiles(transfer: DataTransfer): Promise<Dropped[]> {
  // Entries must be asked for before anything is waited for: the drop is over then.
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.() ?? null);
  const files = [...transfer.files];
  const found: Dropped[] = [];
  for (const [place, entry] of entries.entries())
    if (entry?.isDirectory) await walk(entry as FileSystemDirectoryEntry, "", found);
    else if (entry?.isFile) found.push({ path: entry.name, file: await fileOf(entry as FileSystemFileEntry) });
    else if (files[place]) found.push({ path: files[place].name, file: files[place] });
  return found.length ? found : chosenFiles(files);
}

/** Files chosen in a dialog; those of a folder bring their paths. */
export function chosenFiles(files: Iterable<File>): Dropped[] {
  return [...files].map((file) => ({ path: file.webkitRelativePath || file.name, file })).filter(({ path }) => !hidden(path));
}

/** Whether a file lies in a folder that was dropped. */
export function inFolder({ path }: Dropped): boolean {
  return path.includes("/");
}

export function isTable({ file }: Dropped): boolean {
  return /\.(csv|txt|tsv)$/i.test(file.name);
}

/** Options of a request that brings them all: a list of paths and sizes, then what is in them. */
export function packed(files: readonly Dropped[]): RequestInit {
  const list = JSON.stringify(files.map(({ path, file }) => [path, file.size]));
  const body = new Blob([list, "\n", ...files.map(({ file }) => file)]);
  const headers = { "Content-Type": "application/octet-stream", "X-File-Name": "dropped" };
  return { method: "POST", body, headers };
}

async function walk(folder: FileSystemDirectoryEntry, above: string, into: Dropped[]): Promise<void> {
  const path = `${above}${folder.name}/`;
  for (const entry of await entriesOf(folder)) {
    if (hidden(entry.name)) continue;
    if (entry.isDirectory) await walk(entry as FileSystemDirectoryEntry, path, into);
    else into.push({ path: path + entry.name, file: await fileOf(entry as FileSystemFileEntry) });
  }
}

function hidden(path: string): boolean {
  return path.split("/").some((part) => part.startsWith("."));
}

/** A reader gives some hundred entries at a time, and none at the end. */
async function entriesOf(folder: FileSystemDirectoryEntry): Promise<FileSystemEntry[]> {
  const reader = folder.createReader();
  const found: FileSystemEntry[] = [];
  for (;;) {
    const next = await new Promise<FileSystemEntry[]>((done, failed) => reader.readEntries(done, failed));
    if (!next.length) return found;
    found.push(...next);
  }
}

function fileOf(entry: FileSystemFileEntry): Promise<File> {
  return new Promise((done, failed) => entry.file(done, failed));
}
