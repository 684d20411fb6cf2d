// The JSON interface of the library: this page asks and draws, and computes nothing of its own.

export class ApiError extends Error {
  constructor(status, body) {
    super(
      body?.error ??
        (status ? `The program answered ${status}.` : "The program does not answer. Is it still running?"),
    );
    this.status = status;
    this.body = body ?? {};
  }

  get faults() {
    return this.body.faults ?? [];
  }
}

/** The study that requests are about, and who hears that another window has opened another one. */
export const about = { study: null, overtaken: () => {} };

const studyHeader = (path) =>
  about.study === null || path.startsWith("/api/session")
    ? {}
    : { "fingerpad-study": encodeURIComponent(about.study) };

async function ask(method, path, { body, query, signal } = {}) {
  const address = query ? `${path}?${new URLSearchParams(clean(query))}` : path;
  const options = { method, signal, headers: studyHeader(path) };
  if (body !== undefined) {
    options.headers["content-type"] = "application/json";
    options.body = JSON.stringify(body);
  }
  let response;
  try {
    response = await fetch(address, options);
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new ApiError(0);
  }
  const answer = await response.json().catch(() => null);
  if (response.status === 409 && answer?.study !== undefined) about.overtaken();
  if (!response.ok) throw new ApiError(response.status, answer);
  return answer;
}

function clean(query) {
  return Object.fromEntries(
    Object.entries(query).filter(([, value]) => value !== undefined && value !== null && value !== ""),
  );
}

export const get = (path, query, signal) => ask("GET", path, { query, signal });
export const post = (path, body = {}, signal) => ask("POST", path, { body, signal });
export const put = (path, body) => ask("PUT", path, { body });
export const remove = (path, body) => ask("DELETE", path, { body });

export const picture = (kind, item, more = {}) =>
  `/api/picture/${kind}?${new URLSearchParams({ item, ...clean(more) })}`;

/** Send one file as it is; `progress` hears the share sent. */
export function upload(file, { folder, progress } = {}) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("POST", `/api/files?${new URLSearchParams(clean({ name: file.name, folder }))}`);
    for (const [name, value] of Object.entries(studyHeader("/api/files")))
      request.setRequestHeader(name, value);
    request.responseType = "json";
    request.upload.onprogress = (event) => event.lengthComputable && progress?.(event.loaded / event.total);
    request.onload = () =>
      request.status < 300
        ? resolve(request.response)
        : reject(new ApiError(request.status, request.response));
    request.onerror = () => reject(new ApiError(0));
    request.send(file);
  });
}

/** One request at a time, then the newest: what a dragged handle needs. After `drop` nothing asked before is heard. */
export class Newest {
  #send;
  #done;
  #failed;
  #waiting = null;
  #busy = false;
  #dropped = 0;
  #shown;

  /** `shown`, the place of the answers, is busy until the newest stands there. */
  constructor(send, done, failed, shown) {
    this.#send = send;
    this.#done = done;
    this.#failed = failed;
    this.#shown = shown;
  }

  ask(state) {
    this.#waiting = state;
    this.#shown?.setAttribute("aria-busy", "true");
    if (!this.#busy) this.#run();
  }

  drop() {
    this.#waiting = null;
    this.#dropped += 1;
  }

  async #run() {
    this.#busy = true;
    while (this.#waiting !== null) {
      const [state, dropped] = [this.#waiting, this.#dropped];
      this.#waiting = null;
      try {
        const answer = await this.#send(state);
        if (dropped === this.#dropped) this.#done(answer, state);
      } catch (error) {
        if (dropped === this.#dropped) this.#failed(error, state);
      }
    }
    this.#busy = false;
    this.#shown?.setAttribute("aria-busy", "false");
  }
}
