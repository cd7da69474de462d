// ESLint's recommended rules for the pages' JavaScript: modules of the live page, scripts of the reports.
import js from "@eslint/js";
import globals from "globals";

const browser = { ecmaVersion: 2022, globals: globals.browser };
export default [
  js.configs.recommended,
  { files: ["jobs/page/*.js"], languageOptions: { ...browser, sourceType: "module" } },
  { files: ["validate/report/assets/*.js"], languageOptions: { ...browser, sourceType: "script" } },
];
