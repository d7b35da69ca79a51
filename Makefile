# Everything that needs system packages goes through scripts/setup, which installs what is missing and is silent otherwise.
# ARGS is handed on: make run ARGS="render --material gold --output gold.png"

.DEFAULT_GOAL := help
.PHONY: help run install uninstall check lint test test-thorough test-times docs bench pictures mutants fuzz attack

help: ## Print this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-14s %s\n", $$1, $$2 }' $(firstword $(MAKEFILE_LIST))

run: ## Open the editor (without a display: render the default scene to an image)
	@scripts/setup run
	cargo run --release -- $(ARGS)

install: ## Install for the current user: program, icon, menu entry, file types (PREFIX=~/.local)
	@scripts/setup run
	cargo build --release
	scripts/install

uninstall: ## Remove what `make install` installed; your materials and settings stay
	scripts/install --remove

check: ## The quick loop: format, the ratchet, the tests that concern what you changed
	@scripts/setup test
	scripts/check $(ARGS)

lint: ## Check the format, the lints and that no folder grew
	@if cargo fmt --version >/dev/null 2>&1; then set -x; scripts/format --check; \
	else echo "note: rustfmt is not installed, the format is not checked (rustup component add rustfmt)"; fi
	@if python3 --version >/dev/null 2>&1; then set -x; scripts/tokens --check; \
	else echo "note: Python is not installed, the tokens of the folders are not counted"; fi
	@if cargo clippy --version >/dev/null 2>&1; then set -x; cargo clippy --release --workspace --all-targets -- -D warnings; \
	else echo "note: clippy is not installed, lints are not checked (rustup component add clippy)"; fi

test: ## Run the tests, beside the program that `make run` built
	@scripts/setup test
	cargo build --release
	cargo test --release --package glossmith-tests --package glossmith-numbers -- $(ARGS)

test-times: ## The same, then what the parts took and the 40 slowest tests (docs/BUILD.md)
	@scripts/setup test
	scripts/test-times

fuzz: ## Damaged files of all formats through the program for a while (MINUTES=10); what fails is kept in fuzz/failures
	@scripts/setup run
	cargo build --release
	scripts/fuzz --minutes $(or $(MINUTES),10) $(ARGS)

attack: ## Random stacks of layers against energy, integrals, continuity and strategies (MINUTES=10 SEED=1)
	cargo build --release
	scripts/attack --minutes $(or $(MINUTES),10) --seed $(or $(SEED),1)

test-thorough: lint ## All that there is, for hours: what is random, long or needs other programs, with debug assertions and on other drivers
	@scripts/setup thorough
	cargo build --profile thorough
	cargo test --profile thorough --package glossmith-tests --package glossmith-numbers --all-features -- $(ARGS)
	scripts/fuzz --minutes 5 --program target/thorough/glossmith
	cargo check --release --no-default-features
	scripts/second-driver
	@if cargo deny --version >/dev/null 2>&1; then set -x; cargo deny check; \
	else echo "note: cargo-deny is not installed, advisories and licences are not checked (cargo install --locked cargo-deny)"; fi

docs: ## Build the book into target/book (mdBook, without a network)
	@command -v mdbook >/dev/null 2>&1 || { echo "error: mdBook is not installed: run cargo install mdbook" >&2; exit 1; }
	mdbook build docs

bench: ## Measure what docs/PERFORMANCE.md quotes
	cargo bench $(ARGS)

pictures: ## Make the images of the documentation again (GLOSSMITH=PROGRAM takes a build that is there)
	@scripts/setup pictures
	scripts/pictures

mutants: ## Mutation testing (MINUTES=60 SEED=1; CONTRIBUTING.md)
	@scripts/setup test
	scripts/mutants $(or $(MINUTES),60) $(or $(SEED),1)
