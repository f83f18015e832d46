// All tests in one process and one browser, one after the other; those that measure time first.
import "./speed.test.mjs";
import "./values.test.mjs";
import "./scene.test.mjs";
import "./deep.test.mjs";
import "./touch.test.mjs";
import "./layout.test.mjs";
import "./letters.test.mjs";
import "./cutter.test.mjs";
import "./learn.test.mjs";
import "./several.test.mjs";
import "./page.test.mjs";
import "./partial.test.mjs";
import "./inspection.test.mjs";
import "./odd.test.mjs";
import "./plan.test.mjs";
import "./picture.test.mjs";
