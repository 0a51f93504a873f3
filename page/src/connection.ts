/** The way to the server that sent the page: every request carries the session's secret. */

const KEPT = "auricle-session";

export class RequestError extends Error {
  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
  }
}

export interface ServerEvent {
  readonly event: string;
  readonly data: unknown;
}

/** What the server has open, as `POST /api/session` answers. */
export interface SessionInfo {
  /** For the header `Authorization: Bearer …` of all further requests. */
  readonly secret?: string;
  /** Names of the views that have something to show: "explore", "plan", "segment", "cohort". */
  readonly views: readonly string[];
  /** Words for the head of the page: the file's name. */
  readonly title: string;
  /** Anything further the views want to know. */
  readonly [key: string]: unknown;
}

export class Connection {
  private secret = "";

  /** Exchanges the one-time token of the address for the session's secret. */
  async begin(): Promise<SessionInfo> {
    const token = new URLSearchParams(location.hash.slice(1)).get("token");
    if (token) history.replaceState(null, "", location.pathname);
    this.secret = token ?? sessionStorage.getItem(KEPT) ?? "";
    const info = await this.json<SessionInfo>("/api/session", { method: "POST" });
    if (info.secret) this.secret = info.secret;
    sessionStorage.setItem(KEPT, this.secret);
    return info;
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
    const headers = { "Content-Type": "application/json" };
    return this.json<T>(path, { method: "POST", body: JSON.stringify(value), headers, ...options });
  }

  /** Reads a stream of events (text/event-stream) to its end; JSON in `data:` is parsed. */
  async stream(
    path: string,
    options: RequestInit,
    heard: (event: ServerEvent) => void,
  ): Promise<void> {
    const body = (await this.request(path, options)).body;
    if (!body) return;
    const reader = body.pipeThrough(new TextDecoderStream()).getReader();
    let rest = "";
    for (;;) {
      const { value, done } = await reader.read();
      if (done) return;
      const blocks = (rest + value.replaceAll("\r\n", "\n")).split("\n\n");
      rest = blocks.pop() ?? "";
      for (const block of blocks) {
        const event = parsed(block);
        if (event) heard(event);
      }
    }
  }
}

function parsed(block: string): ServerEvent | null {
  let event = "message";
  const data: string[] = [];
  for (const line of block.split("\n")) {
    if (line.startsWith("event:")) event = line.slice(6).trim();
    if (line.startsWith("data:")) data.push(line.slice(5).trimStart());
  }
  return data.length ? { event, data: JSON.parse(data.join("\n")) as unknown } : null;
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
