/** The way to the server that sent the page: every request carries the session's secret. */

const KEPT = "auricle-secret";

export class RequestError extends Error {
  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
  }
}

/** How far a long piece of work is. */
export interface Stage {
  readonly stage: string;
  readonly done: number;
  readonly total: number;
}

/** What is open, as `GET /api/page` answers. */
export interface SessionInfo {
  /** Names of the views that have something to show: "explore", "plan", "segment", "cohort". */
  readonly views: readonly string[];
  /** Words for the head of the page. */
  readonly name: string;
  /** Anything further the views want to know. */
  readonly [key: string]: unknown;
}

export class Connection {
  private secret = "";

  /** Exchanges the one-time token of the address for the session's secret. */
  async begin(): Promise<void> {
    const token = new URLSearchParams(location.hash.slice(1)).get("token");
    this.secret = sessionStorage.getItem(KEPT) ?? "";
    if (!token) return;
    history.replaceState(null, "", location.pathname);
    this.secret = (await this.send<{ secret: string }>("/api/session", { token })).secret;
    sessionStorage.setItem(KEPT, this.secret);
  }

  /** A request with the secret; throws a RequestError with the server's own words if refused. */
  async request(path: string, options: RequestInit = {}): Promise<Response> {
    const headers = new Headers(options.headers);
    headers.set("Authorization", `Bearer ${this.secret}`);
    const answer = await fetch(path, { ...options, headers, cache: "no-store" });
    if (!answer.ok) throw new RequestError(answer.status, await words(answer));
    return answer;
  }

  async json<T>(path: string, options: RequestInit = {}): Promise<T> {
    return (await (await this.request(path, options)).json()) as T;
  }

  /** Sends a value as JSON and reads the answer as JSON. */
  async send<T>(path: string, value: unknown, options: RequestInit = {}): Promise<T> {
    return this.json<T>(path, posted(value, options));
  }

  /** Starts long work, hears how far it is, and waits for its result; aborting cancels it. */
  async work<T>(path: string, options: RequestInit, heard: (stage: Stage) => void): Promise<T> {
    const body = (await this.request(path, options)).body;
    if (!body) throw new Error("the server sent no answer: try again");
    const reader = body.pipeThrough(new TextDecoderStream()).getReader();
    let rest = "";
    for (;;) {
      const { value, done } = await reader.read();
      if (done) throw new Error("the work ended without a result: try again");
      const lines = (rest + value).split("\n");
      rest = lines.pop() ?? "";
      for (const line of lines.filter(Boolean)) {
        const told = JSON.parse(line) as Partial<Stage> & { result?: T; error?: string };
        if (told.error !== undefined) throw new RequestError(422, told.error);
        if (told.result !== undefined) return told.result;
        heard(told as Stage);
      }
    }
  }
}

/** Options of a request that brings a value as JSON. */
export function posted(value: unknown, options: RequestInit = {}): RequestInit {
  const headers = { "Content-Type": "application/json" };
  return { method: "POST", body: JSON.stringify(value), headers, ...options };
}

/** Options of a request that brings a file. */
export function uploaded(file: File, options: RequestInit = {}): RequestInit {
  const headers = {
    "Content-Type": "application/octet-stream",
    "X-File-Name": encodeURIComponent(file.name),
  };
  return { method: "POST", body: file, headers, ...options };
}

async function words(answer: Response): Promise<string> {
  const text = await answer.text();
  try {
    const said = (JSON.parse(text) as { error?: unknown }).error;
    if (typeof said === "string") return said;
  } catch {
    // Not JSON: the text itself is what was said.
  }
  return text.slice(0, 300) || `the server answered ${answer.status}`;
}
