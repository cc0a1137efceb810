"""One page with everything under the results, which opens offline.

Inputs: what the default target makes, and the samples of the models whose solids the page shows. Output: one HTML
file. It takes every table and figure it finds, those of other targets included.
"""


rule report_page:
    input:
        rules.all.input,
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
        code=stage_digest("report"),
    shell:
        "tetgan report {params.results:q} {output.page:q} --config {params.config:q}"
        " --captions {params.captions:q} {params.models} >{log:q} 2>&1"
