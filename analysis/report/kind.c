#include "analysis/report/kind.h"

#include <string.h>

#include "analysis/report/files.h"
#include "analysis/report/glossary.h"

enum wb_status wb_kind_read(const struct wb_kind *kind, void *campaign, const char *path)
{
    struct wb_campaign *const head = campaign;
    struct wb_config *config;
    memset(campaign, 0, kind->campaign_size);
    WB_TRY(wb_campaign_open(head, &config, path));
    const struct wb_config_node *const root = wb_config_root(config);
    enum wb_status status = wb_laboratory_read(wb_config_find(root, "laboratory"),
                                               kind->has_uncertainties, &head->laboratory);
    if (status == WB_OK)
        status = kind->keys(campaign, root);
    wb_config_destroy(config);
    if (status != WB_OK)
        kind->release_campaign(campaign);
    return status;
}

enum wb_status wb_kind_write(const struct wb_kind *kind, const void *results, const char *folder,
                             bool force, int n_threads)
{
    const struct wb_kind_outcome *const outcome = results;
    const struct wb_laboratory *const laboratory = &outcome->campaign->laboratory;
    struct wb_figures figures;
    struct wb_document document;
    struct wb_cards cards = {0};
    WB_TRY(wb_figures_create(&figures, kind->figures, kind->n_figures, results));
    enum wb_status status = kind->cards ? kind->cards(&cards, results) : WB_OK;
    kind->pages(&document, results, &figures);
    wb_cards_put_pages(&document, &cards);
    wb_glossary_put(&document);
    wb_laboratory_put_pages(&document, laboratory);
    struct wb_json *const numbers = kind->json(results);
    wb_laboratory_put_numbers(numbers, laboratory);
    if (status == WB_OK)
        status = wb_files_write(&document, &figures, &cards, numbers, folder, force, n_threads);
    wb_cards_release(&cards);
    wb_json_destroy(numbers);
    wb_document_release(&document);
    wb_figures_release(&figures);
    return status;
}
