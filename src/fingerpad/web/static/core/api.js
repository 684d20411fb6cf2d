// Requests to the JSON API. The page shows results; all of them are computed by the library.

export class ApiError extends Error {
  /**
   * @param {number} status 0 if there was no answer
   * @param {Answers["Refusal"] | { error: string } | null} [body]
   */
  constructor(status, body) {
    super(
      body?.error ??
        (status
          ? `The server responded with status ${status}.`
          : "fingerpad does not respond: this was not saved or read. Is it still running?"),
    );
    this.status = status;
    /** @type {Partial<Answers["Refusal"]>} */
    this.body = body ?? {};
  }

  get faults() {
    return this.body.faults ?? [];
  }
}

/** Name of this window's study, which all requests are about; other windows have their own. */
export const context = { study: /** @type {string | null} */ (null) };

/**
 * The address of a request: about this window's study, or, with `/api/`, about the workspace.
 *
 * @param {string} path
 * @param {Record<string, any>} [query] of which nothing empty is sent
 */
export function addressOf(path, query = {}) {
  const known = Object.entries(query).filter(([, value]) => (value ?? "") !== "");
  const address = path.startsWith("/api/")
    ? path
    : `/api/studies/${encodeURIComponent(context.study)}${path}`;
  return known.length ? `${address}?${new URLSearchParams(Object.fromEntries(known))}` : address;
}

/**
 * @param {string} method
 * @param {string} path
 * @param {{ body?: object, query?: object, signal?: AbortSignal }} content
 * @returns {Promise<any>}
 */
async function request(method, path, { body, query, signal }) {
  /** @type {Record<string, string>} */
  const headers = {};
  if (body !== undefined) headers["content-type"] = "application/json";
  let response;
  try {
    response = await fetch(addressOf(path, query), {
      method,
      signal,
      headers,
      body: body && JSON.stringify(body),
    });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new ApiError(0);
  }
  const answer = await response.json().catch(() => null);
  if (!response.ok) throw new ApiError(response.status, answer);
  return answer;
}

/**
 * @template {GetPath} P
 * @param {P} path
 * @param {QueryOf<P, "get">} [query]
 * @param {AbortSignal} [signal]
 * @returns {Promise<AnswerTo<P, "get">>}
 */
export const get = (path, query, signal) => request("GET", path, { query, signal });

/**
 * @template {PostPath} P
 * @param {P} path
 * @param {BodyOf<P, "post">} [body]
 * @param {AbortSignal} [signal]
 * @returns {Promise<AnswerTo<P, "post">>}
 */
export const post = (path, body, signal) => request("POST", path, { body: body ?? {}, signal });

/** Remove an uploaded file. @param {string} file @returns {Promise<Answers["Removal"]>} */
export const removeFile = (file) => request("DELETE", "/files", { query: { file } });

/** Address of a small picture of an item. @param {string} item */
export const thumbnailOf = (item) => addressOf("/picture/thumbnail", { item });

/** Where a contact image, or a frame of a sequence, is reviewed; without an item, the sequence. */
export function contactAddress(item, sequence = null) {
  const parts = [sequence ? `sequence:${sequence}` : "images", item].filter(Boolean);
  return `#/contacts/${parts.map(encodeURIComponent).join("/")}`;
}

/** Address of a file of the results, or of the study folder as a ZIP. */
export const download = (file) => addressOf(`/download/${file}`);

/**
 * Send a file; `progress` is called with the fraction sent.
 *
 * @param {string} path
 * @param {Record<string, any>} query
 * @param {File} file
 * @param {(fraction: number) => void} [progress]
 * @returns {Promise<any>} the answer
 */
export function send(path, query, file, progress) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("POST", addressOf(path, query));
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

/**
 * Sends one request at a time, and then the latest state only, as a dragged handle needs. Answers to requests
 * made before `cancel` are ignored.
 *
 * @template S, A
 */
export class LatestRequest {
  #send;
  #done;
  #failed;
  /** @type {S | null} */
  #waiting = null;
  #busy = false;
  #cancelled = 0;
  #busyElement;

  /**
   * @param {(state: S) => Promise<A>} send
   * @param {(answer: A, state: S) => void} done
   * @param {(error: any, state: S) => void} failed
   * @param {Element} [busyElement] is `aria-busy` until it shows the latest answer
   */
  constructor(send, done, failed, busyElement) {
    this.#send = send;
    this.#done = done;
    this.#failed = failed;
    this.#busyElement = busyElement;
  }

  /** @param {S} state */
  request(state) {
    this.#waiting = state;
    this.#busyElement?.setAttribute("aria-busy", "true");
    if (!this.#busy) this.#run();
  }

  cancel() {
    this.#waiting = null;
    this.#cancelled += 1;
  }

  async #run() {
    this.#busy = true;
    while (this.#waiting !== null) {
      const [state, cancelled] = [this.#waiting, this.#cancelled];
      this.#waiting = null;
      try {
        const answer = await this.#send(state);
        if (cancelled === this.#cancelled) this.#done(answer, state);
      } catch (error) {
        if (cancelled === this.#cancelled) this.#failed(error, state);
      }
    }
    this.#busy = false;
    this.#busyElement?.setAttribute("aria-busy", "false");
  }
}
