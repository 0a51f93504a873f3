/** Starts the page. */
import "./style/page.css";
import { PageApp } from "./app";
import { PageFrame } from "./frame";

import.meta.glob("./*/view.ts", { eager: true });
import.meta.glob("./*/*.css", { eager: true });

const app = new PageApp();
const root = document.getElementById("app");
if (root) void new PageFrame(root, app).begin();
