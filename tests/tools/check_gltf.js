// Exported models, judged by the validator of Khronos: check_gltf.js FOLDER_OF_THE_VALIDATOR FILE...
// Prints a line for each error and warning and ends with 1 where there is one.
const fs = require("fs");
const path = require("path");
const validator = require(path.join(process.argv[2], "gltf-validator"));

(async () => {
  let wrong = 0;
  for (const file of process.argv.slice(3)) {
    const beside = (uri) => fs.promises.readFile(path.join(path.dirname(file), decodeURIComponent(uri)));
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
      uri: file,
      externalResourceFunction: (uri) => beside(uri).then((bytes) => new Uint8Array(bytes)),
    });
    for (const message of report.issues.messages.filter((message) => message.severity < 2)) {
      console.log(`${file}: ${message.code} at ${message.pointer}: ${message.message}`);
      wrong += 1;
    }
  }
  process.exit(wrong > 0 ? 1 : 0);
})();
