// Types of the page's scripts. "api" is generated from the OpenAPI document (npm run types).
import type { components, paths } from "api";

type Method = "get" | "post" | "delete";
/** The scripts write the addresses of a study without what all of them begin with. */
type Short<P> = P extends `/api/studies/{study}${infer Rest}` ? Rest : P;
type Operations = { [P in keyof paths as Short<P>]: paths[P] };
type Operation<P extends keyof Operations, M extends Method> = Operations[P][M];
type PathsWith<M extends Method> = {
  [P in keyof Operations]: [Exclude<Operations[P][M], undefined>] extends [never] ? never : P;
}[keyof Operations];
type Json<T> = T extends { content: { "application/json": infer Content } } ? Content : never;
type Success<R> = Json<R[Extract<keyof R, 200 | 201 | 202>]>;

declare global {
  type Answers = components["schemas"];
  type GetPath = PathsWith<"get">;
  type PostPath = PathsWith<"post">;
  type AnswerTo<P extends keyof Operations, M extends Method> =
    Operation<P, M> extends { responses: infer R } ? Success<R> : never;
  type QueryOf<P extends keyof Operations, M extends Method> =
    Operation<P, M> extends { parameters: { query?: infer Q } } ? Q : never;
  type BodyOf<P extends keyof Operations, M extends Method> =
    Operation<P, M> extends { requestBody: infer B } ? Json<B> : Record<string, never>;

  /** (row, column) in pixels of the full image. */
  type Point = [number, number];
  type Points = [number, number][];
  type State = Answers["State"];
  type Observation = State["observations"][number];
  type Sequence = State["sequences"][number];
  type Finger = State["fingers"][number];
  type Photograph = Finger["photographs"][number] & { finger: string };
  type Frame = Answers["FrameEntry"];
  type ContactMeasurement = Answers["ContactMeasurement"];
  type PhotographMeasurement = Answers["PhotographMeasurement"];
  type ScaleMeasurement = Answers["ScaleMeasurement"];
  type AnyScale = Exclude<BodyOf<"/measure/scale", "post">["table"], string>;
  /** A scale's table as the manifest states it; it may not be complete. */
  type ScaleTable = { [K in AnyScale extends infer T ? (T extends T ? keyof T : never) : never]?: any };
  type Edit = BodyOf<"/edits", "post">["edits"][number];
  type ContactChange = NonNullable<BodyOf<"/measure/contact", "post">["change"]>;
  type PhotographChange = NonNullable<BodyOf<"/measure/photograph", "post">["change"]>;
  type Change = ContactChange & PhotographChange;

  type PhaseStart = Answers["PhaseStart"];
  /** Scales of a time axis, its ends (s), its edges (px), and the time by which a key moves a limit (s). */
  interface TimeAxis {
    x: (time: number) => number;
    time: (x: number) => number;
    ends: number[];
    top: number;
    bottom: number;
    height: number;
    step: number;
  }
  type Vector = [number, number, number];
  /** A flat face of the pad, the platen or the wedge. */
  interface PadFace {
    corners: Vector[];
    centre: Vector;
    normal: Vector;
    colour: number[];
  }

  /** A quantity of an answer, as it is shown. */
  type Shown = [key: string, words: string, symbol?: string, title?: string, mark?: string];
  /** A tool: its name and that of its icon, its words, its key, and what the list of keys says of it. */
  type Tool = [tool: string, words: string, shortcut: string, help?: string];

  /** A view of one step; `navigate` returns whether it can show the rest of an address. */
  interface View {
    navigate?(rest: string[]): boolean;
    update?(): void;
    close?(): void;
  }

  interface HTMLElement {
    /** Shows another value in a control of several elements. */
    show?(value: any): void;
  }

  interface Window {
    Plotly: {
      react(root: Element, traces: object[], layout: object, config: object): Promise<void>;
      purge(root: Element): void;
    };
  }
}
