"""One page with everything under the results, which opens offline.

Inputs: what the default target makes, every other table and figure that is there when Snakemake starts, and the
samples of the models whose solids the page shows. Output: one HTML file. What `paper` adds is on the next page.
"""

CAPTIONS = WORKFLOW / "report"
# With these as inputs a page is out of date when one of them is, or when there are more.
FOUND = [
    target
    for target in PAPER_TARGETS
    if Path(target.replace("<results>", RESULTS)).is_file()
]


rule report_page:
    input:
        sorted({*DEFAULT_TARGETS, *FOUND}),
        samples=expand(
            each_mode(
                "<results>/samples/{{category}}/{model}/{seed}/{mode}",
                SHOWN_MODELS,
                seeds=config["seeds"][:1],
            ),
            category=config["categories"],
        ),
        captions=sorted(CAPTIONS.glob("*.rst")),
    output:
        page="<results>/report.html",
    log:
        "<logs>/report_page.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=1500,
    params:
        results=subpath(output.page, parent=True),
        captions=CAPTIONS,
        config=json.dumps(config),
        models=[f"--model {name}" for name in SHOWN_MODELS],
        code=code_digest("tetgan.report.page:report_page"),
    shell:
        "tetgan report {params.results:q} {output.page:q} --config {params.config:q}"
        " --captions {params.captions:q} {params.models} >{log:q} 2>&1"
