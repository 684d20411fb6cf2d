// Types of the page's scripts. "api" is generated from the OpenAPI document (npm run types).
import type { components, paths } from "api";

type Method = "get" | "post" | "delete";
type Operation<P extends keyof paths, M extends Method> = paths[P][M];
type PathsWith<M extends Method> = {
  [P in keyof paths]: [Exclude<paths[P][M], undefined>] extends [never] ? never : P;
}[keyof paths];
type Json<T> = T extends { content: { "application/json": infer Content } } ? Content : never;
type Success<R> = Json<R[Extract<keyof R, 200 | 201 | 202>]>;

declare global {
  type Answers = components["schemas"];
  type GetPath = PathsWith<"get">;
  type PostPath = PathsWith<"post">;
  type DeletePath = PathsWith<"delete">;
  type AnswerTo<P extends keyof paths, M extends Method> =
    Operation<P, M> extends { responses: infer R } ? Success<R> : never;
  type QueryOf<P extends keyof paths, M extends Method> =
    Operation<P, M> extends { parameters: { query?: infer Q } } ? Q : never;
  type BodyOf<P extends keyof paths, M extends Method> =
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
  type AnyScale = Exclude<BodyOf<"/api/measure/scale", "post">["table"], string>;
  /** A scale's table as the manifest states it; it may not be complete. */
  type ScaleTable = { [K in AnyScale extends infer T ? (T extends T ? keyof T : never) : never]?: any };
  type Edit = BodyOf<"/api/study/edits", "post">["edits"][number];
  type ContactChange = NonNullable<BodyOf<"/api/measure/contact", "post">["change"]>;
  type PhotographChange = NonNullable<BodyOf<"/api/measure/photograph", "post">["change"]>;
  type Change = ContactChange & PhotographChange;

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
