# What people run. Every target first installs what is missing (setup.sh) and then calls cargo.

.PHONY: gate test torture soak fuzz validate stability baselines bench prices docs book setup

# Where rustup puts cargo, for shells that were open before.
export PATH := $(PATH):$(HOME)/.cargo/bin
BIN := $(or $(CARGO_TARGET_DIR),target)/release/halfstep

# Builds, and runs the elastic gate coarse enough to watch: two water particles a plate's thickness, five across it.
gate: setup
	cargo build --release -p halfstep-cli
	$(BIN) run scenes/elastic-gate.toml --set resolution=0.0025 --set shape.plate.across=5 --out out/elastic-gate --force
	@echo "The gate's tip beside the experiment: $(CURDIR)/out/elastic-gate/plot.png"

# The whole test suite.
test: setup
	cargo test --release --workspace

# The benchmarks of the literature at full resolution, and long tests of solids alone.
validate: setup
	cargo test --release -p halfstep-tests -- --ignored --nocapture
	cargo test --release -p halfstep-solid --lib -- --ignored --nocapture

# Interrupts real runs at random instants by random signals, and resumes them: RUNS (1000) of them or SECONDS long.
torture: setup
	cargo build --release -p halfstep-tests --bins
	target/release/torture $(or $(RUNS),1000) $(or $(SECONDS),1000000)

# Short runs, eight at once, for an hour (SECONDS), and one of STEPS (1000000) steps: nothing that they hold may grow.
soak: setup
	cargo build --release -p halfstep-tests --bins
	target/release/soak $(or $(SECONDS),3600) 8 $(or $(STEPS),1000000)

# Coverage-guided fuzzing of all that reads bytes of others, SECONDS (600) for each; what is new goes to target/corpus.
# Its tool goes to target/tools; the instrumentation is no stable feature of the compiler, hence the variable.
CARGO_FUZZ_VERSION := 0.13.2
CARGO_FUZZ := target/tools/cargo-fuzz-$(CARGO_FUZZ_VERSION)/bin/cargo-fuzz
fuzz: setup $(CARGO_FUZZ)
	for target in scene curve outline drawing message checkpoint; do \
		mkdir -p target/corpus/$$target; \
		RUSTC_BOOTSTRAP=1 $(CARGO_FUZZ) run --fuzz-dir tests/fuzz --features libfuzzer --target-dir target/fuzz \
			$$target target/corpus/$$target tests/fuzz/corpus/$$target -- \
			-max_total_time=$(or $(SECONDS),600) -max_len=65536 -timeout=20 -rss_limit_mb=4096 || exit 1; \
	done

$(CARGO_FUZZ):
	cargo install --locked --version $(CARGO_FUZZ_VERSION) --root target/tools/cargo-fuzz-$(CARGO_FUZZ_VERSION) cargo-fuzz

# Stores the bits of the coarse runs in validation/CASE/baseline.toml anew, at each instruction set level of this
# processor, and prints which changed. Say in CHANGELOG.md why they did.
baselines: setup
	HALFSTEP_RENEW=1 cargo test --release -p halfstep-tests --test suite baselines::every_run -- --nocapture

# Hard cases with and without their remedies, at all resolutions: renews the table of docs/stability.md. Minutes.
stability: setup
	HALFSTEP_PAGE=1 cargo test --release -p halfstep-tests --test suite stability:: -- --ignored --nocapture

# What accuracy costs in the shipped scenes, docs/price-lists.md: minutes to an hour. SCENES="..." renews some of them.
prices: setup
	cargo build --release
	sh docs/price-lists.sh $(BIN) $(SCENES)

# Criterion's benchmarks, then the table of ratios and that of the exchange (both also in target/bench.json).
bench: setup
	cargo bench -p halfstep-tests --bench criterion
	cargo bench -p halfstep-tests --bench table
	cargo bench -p halfstep-tests --bench exchange

# The documentation of the crates, in target/doc.
docs: setup
	RUSTDOCFLAGS="-D warnings" cargo doc --release --no-deps --workspace

# All pages as a book, in target/book; nothing is fetched when it is read. Its tools go to target/tools: mdbook, and
# mathcore, which makes MathML of the formulas.
MDBOOK_VERSION := 0.5.4
MDBOOK := target/tools/mdbook-$(MDBOOK_VERSION)/bin/mdbook
MATHCORE_VERSION := 0.7.0
MATHCORE := target/tools/math-core-$(MATHCORE_VERSION)/bin/mathcore
book: setup $(MDBOOK) $(MATHCORE)
	sh docs/book.sh $(abspath $(MDBOOK)) $(abspath $(MATHCORE))

$(MDBOOK):
	cargo install --locked --version $(MDBOOK_VERSION) --root target/tools/mdbook-$(MDBOOK_VERSION) \
		--no-default-features --features search mdbook

$(MATHCORE):
	cargo install --locked --version $(MATHCORE_VERSION) --root target/tools/math-core-$(MATHCORE_VERSION) math-core-cli

setup:
	@./setup.sh
