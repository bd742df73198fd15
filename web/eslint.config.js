/** What eslint holds the page to: typescript-eslint's strictest rules, which know types, with the exceptions that are explained here. */
import js from "@eslint/js";
import { defineConfig } from "eslint/config";
import { configs } from "typescript-eslint";

/** `x!` anywhere but in `array[i]!`; a name in brackets is no index. */
const ALL_BUT_INDICES = "TSNonNullExpression:not(:has(> MemberExpression[computed=true])), TSNonNullExpression > MemberExpression > Literal[raw=/^[^0-9]/]";

export default defineConfig(
  { linterOptions: { reportUnusedDisableDirectives: "error" } },
  js.configs.recommended,
  {
    files: ["**/*.ts"],
    extends: [configs.strictTypeChecked, configs.stylisticTypeChecked],
    languageOptions: { parserOptions: { projectService: true, tsconfigRootDir: import.meta.dirname } },
    rules: {
      // `() => this.play()` is how a call is passed on here, and a number in a text is written as it is.
      "@typescript-eslint/no-confusing-void-expression": ["error", { ignoreArrowShorthand: true }],
      "@typescript-eslint/restrict-template-expressions": ["error", { allowNumber: true }],
      // An empty text counts as none.
      "@typescript-eslint/prefer-nullish-coalescing": ["error", { ignorePrimitives: { string: true } }],
      // Brackets show that a name is looked up and declared by nobody: `dataset["emotion"]`.
      "@typescript-eslint/dot-notation": ["error", { allowIndexSignaturePropertyAccess: true }],
      // `noUncheckedIndexedAccess` doubts every index, also those of a loop's own bounds: there, and only there, `!` may stand.
      "@typescript-eslint/no-non-null-assertion": "off",
      "no-restricted-syntax": ["error", { selector: ALL_BUT_INDICES, message: "`!` is for indices known to be there; ask, or throw, for all else." }],
    },
  },
);
